// Means of light samples that leave out and count non-finite samples.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "frame/plane.h"

namespace eigenlight {

/// Counters of one tile. They are summed in tile order.
struct RayCounters {
  std::int64_t rays = 0;
  std::int64_t non_finite = 0;  ///< samples left out of the means
};

[[nodiscard]] inline bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Mean of the finite samples. NaN if no sample is finite: the value is unknown, and 0 would mean
/// black.
class FiniteMean {
 public:
  void add(const glm::vec3& sample, RayCounters& counters) {
    if (is_finite(sample)) {
      sum_ += sample;
      ++count_;
    } else {
      ++counters.non_finite;
    }
  }
  [[nodiscard]] glm::vec3 value() const {
    if (count_ == 0) return glm::vec3(std::numeric_limits<float>::quiet_NaN());
    return sum_ / static_cast<double>(count_);
  }

 private:
  glm::dvec3 sum_{0.0};
  int count_ = 0;
};

inline void store_pixel(const glm::vec3& value, int x, int y, Planes<3>& planes) {
  for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)](x, y) = value[c];
}

[[nodiscard]] inline glm::vec3 load_pixel(const Planes<3>& planes, int x, int y) {
  return {planes[0](x, y), planes[1](x, y), planes[2](x, y)};
}

}  // namespace eigenlight
