// Pixels on a regular grid, and what most of them say.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

/// Pixels from one to the next on a grid of about `count` pixels, at least 1.
[[nodiscard]] inline int grid_step(Extent extent, double count) {
  const double pixels = static_cast<double>(extent.pixels());
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / count))));
}

/// The value that a share of `values` is below; 0 if there are none.
template <typename T>
[[nodiscard]] T quantile(std::vector<T> values, double share) {
  if (values.empty()) return T{};
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::lround(share * last));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

template <typename T>
[[nodiscard]] T median(std::vector<T> values) {
  return quantile(std::move(values), 0.5);
}

}  // namespace eigenlight
