#include "sequences/flythrough.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "frame/check.h"
#include "sequences/camera_path.h"
#include "sequences/perturb_lights.h"
#include "sequences/perturb_objects.h"

namespace eigenlight {
namespace {

constexpr int kLastStepFrame = 1'000'000;

constexpr std::array<std::pair<std::string_view, Perturbation::Kind>, 5> kNames{
    {{"none", Perturbation::kNone},
     {"lights", Perturbation::kLights},
     {"objects", Perturbation::kObjects},
     {"step", Perturbation::kStep},
     {"all", Perturbation::kAll}}};

class Flythrough final : public Animation {
 public:
  Flythrough(Scene& scene, Perturbation perturbation, Extent extent)
      : path_(scene.camera_path, kFramesPerSecond),
        lights_(scene.lights),
        up_(scene.up),
        fov_y_(scene.fov_y),
        extent_(extent) {
    const bool all = perturbation.kind == Perturbation::kAll;
    if (all || perturbation.kind == Perturbation::kLights) moving_lights_.emplace(scene);
    if (perturbation.kind == Perturbation::kStep) step_.emplace(scene, perturbation.step_frame);
    if (all || perturbation.kind == Perturbation::kObjects) objects_.emplace(scene, path_, extent);
  }

  [[nodiscard]] SceneState state(int frame) const override {
    const CameraPath::View view = path_.at(frame);
    SceneState state;
    state.camera = look_at(view.eye, view.look_at, up_, fov_y_, extent_);
    state.lights = moving_lights_ ? moving_lights_->at(frame) : step_ ? step_->at(frame) : lights_;
    if (objects_) state.poses = objects_->at(frame);
    return state;
  }

 private:
  CameraPath path_;
  Lights lights_;
  glm::vec3 up_;
  float fov_y_;
  Extent extent_;
  std::optional<LightPerturbation> moving_lights_;
  std::optional<LightStep> step_;
  std::optional<ObjectPerturbation> objects_;
};

}  // namespace

Perturbation parse_perturbation(std::string_view text) {
  const std::string_view name = text.substr(0, text.find(':'));
  const auto found = std::find_if(kNames.begin(), kNames.end(),
                                  [name](const auto& entry) { return entry.first == name; });
  const bool has_frame = name.size() < text.size();
  EL_CHECK(found != kNames.end() && (!has_frame || found->second == Perturbation::kStep),
           "unknown perturbation \"{}\", expected none, lights, objects, all, step or step:FRAME",
           text);
  Perturbation perturbation(found->second);
  if (!has_frame) return perturbation;
  const std::string_view digits = text.substr(name.size() + 1);
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, perturbation.step_frame);
  EL_CHECK(error == std::errc{} && stop == end && perturbation.step_frame >= 1 &&
               perturbation.step_frame <= kLastStepFrame,
           "perturbation \"{}\": expected step:FRAME with a frame of 1 to {}", text,
           kLastStepFrame);
  return perturbation;
}

std::string format_perturbation(const Perturbation& perturbation) {
  if (perturbation.kind == Perturbation::kStep) {
    return fmt::format("step:{}", perturbation.step_frame);
  }
  const auto found = std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) {
    return entry.second == perturbation.kind;
  });
  return std::string(found->first);
}

std::unique_ptr<Animation> make_flythrough(Scene& scene, Perturbation perturbation, Extent extent) {
  check_extent(extent);
  const bool has_triangles =
      std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
        return !scene.meshes[static_cast<std::size_t>(instance.mesh)].triangles.empty();
      });
  EL_CHECK(has_triangles, "scene \"{}\": no triangles to fly through", scene.name);
  return std::make_unique<Flythrough>(scene, perturbation, extent);
}

}  // namespace eigenlight
