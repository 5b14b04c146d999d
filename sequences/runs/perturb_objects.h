// Objects that cross the view: Perturbation::kObjects.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/scene.h"
#include "sequences/runs/camera_path.h"

namespace eigenlight {

/// A ball and a box that fly ahead of the camera and cross the view from side to side, each at its
/// own height and pace. Each flies in a cone from the eye that is free of surfaces, at a fraction
/// of the way to the first one that its cone touches, and is as large as that cone: so it is
/// always in full view, and never stands in anything. The free ways along the whole path are found
/// once, and a smooth curve below them is kept.
class ObjectPerturbation {
 public:
  /// `extent` gives the shape of the view. Reads the surfaces of `scene`, then adds the two objects
  /// to it as its last instances.
  ObjectPerturbation(Scene& scene, const CameraPath& path, Extent extent);

  static constexpr std::size_t kCount = 2;
  /// World transforms of the two at any frame; they repeat with the camera path.
  [[nodiscard]] std::vector<glm::mat4> at(int frame) const;

  /// The ball that holds object `i`.
  struct Ball {
    glm::vec3 center{0.0f};
    float radius = 0.0f;
  };
  [[nodiscard]] Ball ball(std::size_t i, int frame) const;

 private:
  /// Direction of object `i` from the eye, unit.
  [[nodiscard]] glm::vec3 direction(std::size_t i, int frame) const;
  [[nodiscard]] int wrapped(int frame) const;

  const CameraPath path_;
  glm::vec3 up_;
  float fov_y_;
  Extent extent_;
  float slope_;                                    ///< radius over distance
  std::array<std::vector<float>, kCount> travel_;  ///< distance from the eye, for each frame
};

}  // namespace eigenlight
