// The path of a camera through its keys.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Catmull-Rom through camera keys, over frames: a cubic Hermite spline whose tangent at a key is
/// the difference of its neighbors over their time (Catmull and Rom 1974, for keys at any spacing).
/// The camera stops at both ends and turns back: frames f and f + period() have the same view, and
/// so have f and -f, counted from the first key.
class CameraPath {
 public:
  /// Throws std::invalid_argument unless there is a key, all are finite, and seconds ascend.
  CameraPath(std::vector<CameraKey> keys, float frames_per_second);

  struct View {
    glm::vec3 eye{0.0f}, look_at{0, 0, 1};
  };
  [[nodiscard]] View at(int frame) const;

  /// Frames from the first key to the last, at least 1. The path is stretched to whole frames, so
  /// that the way back has the same views.
  [[nodiscard]] int length() const { return length_; }
  [[nodiscard]] int period() const { return 2 * length_; }

 private:
  std::vector<CameraKey> keys_;
  std::vector<View> tangents_;  ///< per second
  int length_ = 1;
};

}  // namespace eigenlight
