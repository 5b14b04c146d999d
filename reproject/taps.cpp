#include "reproject/taps.h"

namespace eigenlight {

void TapOptions::validate() const {
  EL_CHECK(plane_distance > 0.0f && plane_distance <= 1.0f,
           "plane_distance {}: expected (0, 1] of the depth", plane_distance);
  EL_CHECK(normal_cosine >= -1.0f && normal_cosine < 1.0f, "normal_cosine {}: expected [-1, 1)",
           normal_cosine);
}

}  // namespace eigenlight
