#include "temporal/baselines/running_mean.h"

#include <algorithm>

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 2;

}  // namespace

RunningMean::RunningMean(const DenoiserOptions& options)
    : BlendedHistory(options.extent, {.name = "mean", .version = kStateVersion, .bases = 1}),
      output_(make_planes<3>(options.extent)) {}

void RunningMean::blend_tile(const Tile& tile) {
  BasisField& sums = bases();
  for_each_sample(tile, [&](int x, int y, bool usable) {
    float& age = sums.age(x, y);
    const float known = age;
    if (usable) age = std::min(known + 1.0f, kMostFrames);
    for (std::size_t c = 0; c < 3; ++c) {
      float& sum = sums.value(x, y, static_cast<int>(c), 0);
      float mean = known > 0.0f ? sum / known : 0.0f;
      if (usable) mean += (frame().lights[0].radiance[c](x, y) - mean) / age;
      sum = mean * age;
      output_[c](x, y) = mean;
    }
  });
}

}  // namespace eigenlight
