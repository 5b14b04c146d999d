// Objects that cross the view, for Perturbation::kObjects.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/scene.h"
#include "sequences/runs/camera_path.h"

namespace eigenlight {

/// A ball and a box that fly ahead of the camera and cross the view from side to side, each at its
/// own height and speed. Each fills a cone from the eye that is free of surfaces, at a fraction of
/// the distance at which the cone first touches a surface. So it is always in full view and never
/// intersects a surface. The free distances along the whole path are found once; a smooth curve
/// below them is kept.
class ObjectPerturbation {
 public:
  /// Reads the surfaces of `scene`, then adds the two objects as its last instances. `extent` gives
  /// the aspect ratio of the view.
  ObjectPerturbation(Scene& scene, const CameraPath& path, Extent extent);

  static constexpr std::size_t kCount = 2;
  /// World transforms of both objects in any frame; they repeat with the camera path.
  [[nodiscard]] std::vector<glm::mat4> at(int frame) const;

  /// The bounding ball of object `i`.
  struct Ball {
    glm::vec3 center{0.0f};
    float radius = 0.0f;
  };
  [[nodiscard]] Ball ball(std::size_t i, int frame) const;

 private:
  /// Unit direction from the eye to object `i`.
  [[nodiscard]] glm::vec3 direction(std::size_t i, int frame) const;
  [[nodiscard]] int wrapped(int frame) const;

  const CameraPath path_;
  glm::vec3 up_;
  float fov_y_;
  Extent extent_;
  float slope_;                                    ///< radius / distance
  std::array<std::vector<float>, kCount> travel_;  ///< distance from the eye, for each frame
};

}  // namespace eigenlight
