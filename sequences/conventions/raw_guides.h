// The guides of one frame as its files hold them.
#pragma once

#include <optional>
#include <vector>

#include "frame/camera.h"
#include "frame/plane.h"

namespace eigenlight {

/// Guides of one frame as its files hold them: nothing scaled, turned or decoded. Empty planes are
/// absent; all others have the same extent.
struct RawGuides {
  int frame = 0;
  Plane<float> depth;
  Planes<3> normal, albedo, position;
  std::vector<Plane<float>> motion;  ///< 2 to 4 channels, none if absent; further ones are not read
  std::optional<Camera> camera;      ///< in our convention (frame/camera.h)

  /// Of any plane that is not empty; 0 x 0 if all are.
  [[nodiscard]] Extent extent() const {
    for (const Plane<float>* plane : {&depth, &normal[0], &albedo[0], &position[0]}) {
      if (!plane->empty()) return plane->extent();
    }
    return motion.empty() ? Extent{} : motion[0].extent();
  }
};

}  // namespace eigenlight
