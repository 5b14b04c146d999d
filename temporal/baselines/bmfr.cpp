#include "temporal/baselines/bmfr.h"

#include <algorithm>

#include "temporal/baselines/bmfr_fit.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 2;
constexpr int kOffsets = 16;  // after which the shifts of the blocks repeat

}  // namespace

void BmfrOptions::validate() const {
  const auto check = [](float value, std::string_view name) {
    EL_CHECK(value > 0.0f && value <= 1.0f, "{} {}: expected (0, 1]", name, value);
  };
  check(alpha, "alpha");
  check(second_alpha, "second_alpha");
  check(noise, "noise");
}

Bmfr::Bmfr(const DenoiserOptions& options, const BmfrOptions& parts)
    : BlendedHistory(options.extent, {.name = "bmfr",
                                      .version = kStateVersion,
                                      .bases = 2,
                                      .history = {.drops_empty_taps = true}}),
      options_(parts),
      light_(make_planes<3>(options.extent)),
      output_(make_planes<3>(options.extent)) {
  parts.validate();
}

void Bmfr::blend_tile(const Tile& tile) {
  BasisField& field = bases();
  for_each_sample(tile, [&](int x, int y, bool usable) {
    float& frames = field.age(x, y);
    const float share = usable ? std::max(options_.alpha, 1.0f / (frames + 1.0f)) : 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      float& kept = field.value(x, y, static_cast<int>(c), 0);
      if (usable) kept += (frame().lights[0].radiance[c](x, y) - kept) * share;
      light_[c](x, y) = kept;
    }
    if (usable) frames = std::min(frames + 1.0f, kMostFrames);
  });
}

const Planes<3>& Bmfr::finish() {
  const int jitter = (frame().index % kOffsets + kOffsets) % kOffsets;
  bmfr_fit({frame(), light_, age(), jitter, options_.noise}, output_);
  for_each_tile(tiles(), [&](const Tile& tile) { blend_fit(tile); });
  return output_;
}

void Bmfr::blend_fit(const Tile& tile) {
  BasisField& field = bases();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float frames = age()(x, y);
      // Without a sample so far the pixel shows the fit alone, which is not kept.
      if (!(frames > 0.0f)) continue;
      const float share = std::max(options_.second_alpha, 1.0f / frames);
      for (std::size_t c = 0; c < 3; ++c) {
        float& kept = field.value(x, y, static_cast<int>(c), 1);
        kept += (output_[c](x, y) - kept) * share;
        output_[c](x, y) = kept;
      }
    }
  }
}

}  // namespace eigenlight
