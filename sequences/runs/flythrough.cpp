#include "sequences/runs/flythrough.h"

#include <algorithm>
#include <optional>

#include "frame/check.h"
#include "sequences/runs/camera_path.h"
#include "sequences/runs/perturb_lights.h"
#include "sequences/runs/perturb_objects.h"

namespace eigenlight {
namespace {

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
