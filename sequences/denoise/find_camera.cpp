// The camera of a frame, from where the readings say.
#include <optional>

#include "sequences/conventions/camera_solve.h"
#include "sequences/denoise/find_readings.h"

namespace eigenlight {
namespace {

// From pixels of the display window to those of the canvas.
Camera on_canvas(Camera camera, const ExrWindow& display, const ExrWindow& canvas) {
  camera.center.x += static_cast<float>(display.x - canvas.x);
  camera.center.y += static_cast<float>(display.y - canvas.y);
  return camera;
}

}  // namespace

// Attributes of Arnold, pbrt and our own files, then V-Ray's.
std::optional<Camera> camera_of_header(const ExrFile& file) {
  const ExrWindow& window = file.display_window();
  const Extent display{window.width, window.height};
  const auto matrix = [&](const char* name) -> std::optional<ExrMatrix> {
    const auto value = file.attribute(name);
    if (!value || !std::holds_alternative<ExrMatrix>(*value)) return std::nullopt;
    return std::get<ExrMatrix>(*value);
  };
  const auto to_camera = matrix("worldToCamera"), to_ndc = matrix("worldToNDC");
  if (to_camera && to_ndc) return camera_from_matrices(*to_camera, *to_ndc, display);
  const auto transform = matrix("cameraTransform");
  const auto fov = file.attribute("cameraFov");
  if (transform && fov && std::holds_alternative<float>(*fov)) {
    return camera_from_vray(*transform, std::get<float>(*fov), display);
  }
  return std::nullopt;
}

std::optional<Camera> find_camera(const RawFrame& frame, const ViewPlan& view,
                                  const Readings& readings, const ExrWindow& canvas) {
  const ExrFile& file = *frame.files.front();
  const ExrWindow& display = file.display_window();
  std::optional<Camera> camera;
  switch (readings.camera_from) {
    case CameraFrom::kNowhere:
      return std::nullopt;
    case CameraFrom::kFile:
      camera = readings.camera_file->camera(frame.frame, {display.width, display.height});
      break;
    case CameraFrom::kHeader:
      camera = camera_of_header(file);
      break;
    case CameraFrom::kPosition: {
      const RawGuides guides = raw_guides(frame, view);
      const auto fit = solve_camera(guides.position, guides.depth);
      if (!fit) return std::nullopt;
      return fit->camera;
    }
  }
  if (!camera) return std::nullopt;
  return on_canvas(*camera, display, canvas);
}

}  // namespace eigenlight
