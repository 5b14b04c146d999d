// Normals from the slope of depth.
#pragma once

#include <glm/glm.hpp>

#include "frame/camera.h"
#include "frame/plane.h"
#include "sequences/conventions/depth_reading.h"

namespace eigenlight {

/// Unit normals in world space, facing the camera, from differences of the file's depths. All
/// arguments must outlive it.
class DepthSlopes {
 public:
  DepthSlopes(const Plane<float>& depth, const DepthReading& reading, const Camera& camera)
      : depth_(depth), reading_(reading), camera_(camera) {}

  /// False at edges of surfaces, near the picture's border and in the background.
  [[nodiscard]] bool normal_at(int x, int y, glm::vec3& normal) const;

 private:
  [[nodiscard]] float axis_depth(int x, int y) const;
  [[nodiscard]] bool difference(int x, int y, int dx, int dy, glm::vec3& difference) const;

  const Plane<float>& depth_;
  const DepthReading& reading_;
  const Camera& camera_;
};

}  // namespace eigenlight
