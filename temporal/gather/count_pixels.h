// Counts pixels, the same number whatever the threads.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "frame/tiles.h"

namespace eigenlight {

/// Pixels for which is(x, y).
template <typename Is>
[[nodiscard]] std::int64_t count_pixels(Extent extent, const Is& is) {
  std::vector<std::int64_t> rows(static_cast<std::size_t>(extent.height));
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) rows[static_cast<std::size_t>(y)] += is(x, y) ? 1 : 0;
  });
  return std::accumulate(rows.begin(), rows.end(), std::int64_t{0});
}

}  // namespace eigenlight
