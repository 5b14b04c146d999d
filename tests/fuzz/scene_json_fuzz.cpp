// scene.json of any bytes: refused with one line, or every number in it can be rendered with.
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include "frame/camera.h"
#include "render/loading/scene_file_json.h"
#include "sequences/runs/camera_path.h"
#include "tests/fuzz/target.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool unit(const glm::vec3& v) { return std::abs(glm::length(v) - 1.0f) < 1e-3f; }

// Light that can be squared and summed.
bool shines(const glm::vec3& radiance) {
  return finite(radiance) && radiance.x >= 0.0f && radiance.y >= 0.0f && radiance.z >= 0.0f &&
         std::isfinite(dot(radiance, radiance));
}

void check_lights(const SceneDescription& scene) {
  FUZZ_CHECK(shines(scene.lights.sky));
  for (const SunLight& sun : scene.lights.suns) {
    FUZZ_CHECK(unit(sun.to_light) && shines(sun.irradiance));
    FUZZ_CHECK(sun.angular_diameter >= 0.0f && sun.angular_diameter <= 90.0f);
  }
  for (const AreaRect& rect : scene.lights.rects) {
    const glm::vec3 normal = cross(rect.half_u, rect.half_v);
    FUZZ_CHECK(finite(rect.center) && shines(rect.radiance));
    FUZZ_CHECK(std::isfinite(glm::length(normal)) && unit(glm::normalize(normal)));
  }
  for (const SphereLight& sphere : scene.lights.spheres) {
    FUZZ_CHECK(finite(sphere.center) && shines(sphere.radiance));
    FUZZ_CHECK(sphere.radius > 0.0f && std::isfinite(sphere.radius * sphere.radius));
  }
  for (const auto& [name, radiance] : scene.emissive_materials) FUZZ_CHECK(shines(radiance));
}

void check_camera(const SceneDescription& scene) {
  FUZZ_CHECK(unit(scene.up));
  const CameraPath path(scene.camera_path, 24.0f);
  FUZZ_CHECK(path.length() >= 1 && path.period() > path.length());
  for (const int frame : {-1, 0, 1, path.length() / 2, path.length()}) {
    const CameraPath::View view = path.at(frame);
    FUZZ_CHECK(finite(view.eye) && finite(view.look_at));
    try {
      const Camera camera = look_at(view.eye, view.look_at, scene.up, scene.fov_y, {64, 36});
      for (int axis = 0; axis < 3; ++axis) FUZZ_CHECK(unit(camera.world_to_view[axis]));
    } catch (const std::invalid_argument&) {
      // Between its keys a path may lead the eye through the point that it looks at.
    }
  }
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace eigenlight;
  static const TempDir dir;
  static const bool has_model = static_cast<bool>(std::ofstream(dir / "m.obj") << "v 0 0 0\n");
  FUZZ_CHECK(has_model);
  std::ofstream(dir / "scene.json", std::ios::binary) << as_text(data, size);
  try {
    const SceneDescription scene = read_scene_json(dir / "scene.json");
    check_lights(scene);
    check_camera(scene);
    FUZZ_CHECK(scene.exposure > 0.0f && std::isfinite(scene.exposure));
    FUZZ_CHECK(scene.fov_y >= 1.0f && scene.fov_y <= 179.0f);
    FUZZ_CHECK(scene.environment_scale >= 0.0f && std::isfinite(scene.environment_scale));
  } catch (const std::runtime_error& error) {
    FUZZ_CHECK(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
