#include "temporal/eigen/output_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/luminance.h"
#include "frame/strips.h"
#include "reproject/warp.h"

namespace eigenlight {
namespace {

constexpr float kNotShown = std::numeric_limits<float>::quiet_NaN();

}  // namespace

OutputFilter::OutputFilter(Extent extent, const EigenOptions& options)
    : options_(options),
      looks_back_(options.filter && options.look_back),
      tiles_(extent, kCoefficientTile, kCoefficientTile),
      guided_(extent, options.guided),
      guided_light_(make_planes<3>(extent)),
      shown_{Plane<float>(extent), Plane<float>(extent)} {}

void OutputFilter::warp(const TapSegment& taps, const Rect& row) {
  if (looks_back_) warp_plane(shown_.before, taps, row, shown_.now);
}

// The last picture did not show new pixels.
const Plane<float>* OutputFilter::earlier(const Plane<float>& old_age) {
  if (!looks_back_) return nullptr;
  for_each_segment(tiles_, [&](const Tile& row) {
    const float* age = old_age.row(row.y0);
    float* shown = shown_.now.row(row.y0);
    for (int x = row.x0; x < row.x1; ++x) shown[x] = age[x] == 0.0f ? kNotShown : shown[x];
  });
  return &shown_.now;
}

void OutputFilter::keep(const Planes<3>& picture) {
  if (!looks_back_) return;
  for_each_segment(tiles_, [&](const Tile& row) {
    const auto from = [&](std::size_t c) { return picture[c].at(row.x0, row.y0); };
    const float *red = from(0), *green = from(1), *blue = from(2);
    float* shown = shown_.now.at(row.x0, row.y0);
    for (int i = 0; i < row.width(); ++i) shown[i] = luminance(red[i], green[i], blue[i]);
  });
}

// The weight of the pixel's own light grows with age, and so does the variance that it keeps.
std::int64_t OutputFilter::fill_young(const FilterInputs& in, Planes<3>& output,
                                      Plane<float>& variance) {
  const std::int64_t skipped = guided_.process({in.frame, output, in.age, in.young}, guided_light_);
  if (skipped == static_cast<std::int64_t>(tiles_.extent().pixels())) return skipped;
  for_each_tile(tiles_, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        // Pixels without geometry have no neighbors on their surface.
        if (in.young(x, y) == 0 || std::isinf(in.frame.surface.depth(x, y))) continue;
        const float own = in.age(x, y) / options_.young_age;
        for (std::size_t c = 0; c < 3; ++c) {
          const float guided = std::max(guided_light_[c](x, y), 0.0f);
          output[c](x, y) = guided + own * (output[c](x, y) - guided);
        }
        variance(x, y) *= own * own;
      }
    }
  });
  return skipped;
}

}  // namespace eigenlight
