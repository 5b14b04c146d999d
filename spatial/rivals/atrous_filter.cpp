#include "spatial/rivals/atrous_filter.h"

#include <algorithm>
#include <utility>

#include "frame/luminance.h"
#include "spatial/rivals/atrous_filter_kernel.h"

namespace eigenlight {
namespace {

// Where the light is black, colors are equal whatever the divisor; this keeps it a number.
constexpr float kDarkest = 1e-15f;

float inverse_square(float v) { return 1.0f / (v * v); }

}  // namespace

void AtrousFilterOptions::validate() const {
  EL_CHECK(passes >= 1 && passes <= 6, "a-trous filter passes {}: expected 1 to 6", passes);
  EL_CHECK(sigma_color > 0.0f && sigma_color <= 1e6f,
           "a-trous filter sigma_color {}: expected (0, 1e6]", sigma_color);
  EL_CHECK(sigma_normal > 0.0f && sigma_normal <= 10.0f,
           "a-trous filter sigma_normal {}: expected (0, 10]", sigma_normal);
  EL_CHECK(sigma_position > 0.0f && sigma_position <= 10.0f,
           "a-trous filter sigma_position {}: expected (0, 10] of the depth", sigma_position);
}

AtrousFilter::AtrousFilter(Extent extent, const AtrousFilterOptions& options)
    : options_((options.validate(), options)),
      grid_(stage_tiles(extent)),
      planes_(extent, 2 << (options.passes - 1)),
      next_(planes_.make_light()),
      sums_(grid_) {}

void AtrousFilter::process(const SpatialInputs& in, Planes<3>& out) {
  check_spatial(in, out, grid_.extent(), "a-trous filter");
  planes_.load(in);
  float sigma_color = std::max(options_.sigma_color * mean_luminance(), kDarkest);
  for (int i = 0; i < options_.passes; ++i, sigma_color *= 0.5f) {
    const int step = 1 << i;
    const float sigma_normal = static_cast<float>(step) * options_.sigma_normal;
    const AtrousFilterPass pass{planes_,
                                step,
                                inverse_square(sigma_color),
                                inverse_square(sigma_normal),
                                options_.sigma_position,
                                planes_.light,
                                next_};
    for_each_tile(grid_, [&](const Tile& tile) { atrous_filter_tile(pass, tile); });
    std::swap(planes_.light, next_);
  }
  for_each_tile(grid_, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int c = 0; c < 3; ++c) {
        const float* from = planes_.row(planes_.light.color[c], y);
        std::copy(from + tile.x0, from + tile.x1, out[c].at(tile.x0, y));
      }
    }
  });
}

float AtrousFilter::mean_luminance() {
  const TapLight& light = planes_.light;
  for_each_tile(grid_, [&](const Tile& tile) {
    Sum& sum = sums_[tile];
    sum = {};
    for (int y = tile.y0; y < tile.y1; ++y) {
      const auto row = [&](int c) { return planes_.row(light.color[c], y); };
      const float *r = row(0), *g = row(1), *b = row(2), *w = planes_.row(light.weight, y);
      for (int x = tile.x0; x < tile.x1; ++x) {
        sum.luminance += static_cast<double>(luminance(r[x], g[x], b[x]));
        sum.pixels += w[x] > 0.0f ? 1.0 : 0.0;
      }
    }
  });
  Sum all;
  for (const Sum& sum : sums_) {
    all.luminance += sum.luminance;
    all.pixels += sum.pixels;
  }
  return all.pixels > 0.0 ? static_cast<float>(all.luminance / all.pixels) : 0.0f;
}

}  // namespace eigenlight
