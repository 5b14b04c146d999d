// Fewer frames for a page, so that it stays small.
#pragma once

#include <cstddef>
#include <vector>

namespace eigenlight {

/// Every n-th of `frames`, with the least n that leaves no more than `most`. The steps are equal,
/// so that playing them keeps an even pace.
inline std::vector<int> thin_frames(const std::vector<int>& frames, std::size_t most) {
  const std::size_t step = (frames.size() + most - 1) / most;
  std::vector<int> kept;
  for (std::size_t i = 0; i < frames.size(); i += step) kept.push_back(frames[i]);
  return kept;
}

}  // namespace eigenlight
