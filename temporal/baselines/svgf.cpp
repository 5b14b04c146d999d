#include "temporal/baselines/svgf.h"

#include <algorithm>
#include <array>
#include <utility>

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 2;

}  // namespace

void SvgfOptions::validate() const {
  EL_CHECK(alpha > 0.0f && alpha <= 1.0f, "alpha {}: expected (0, 1]", alpha);
  EL_CHECK(moments_alpha > 0.0f && moments_alpha <= 1.0f, "moments_alpha {}: expected (0, 1]",
           moments_alpha);
  EL_CHECK(passes >= 1 && passes <= 6, "passes {}: expected 1 to 6", passes);
  EL_CHECK(feedback >= 0 && feedback <= passes, "feedback {}: expected 0 to {}", feedback, passes);
  weights.validate();
}

Svgf::Svgf(const DenoiserOptions& options, const SvgfOptions& parts)
    : BlendedHistory(options.extent, {.name = "svgf",
                                      .version = kStateVersion,
                                      .bases = 2,
                                      .history = {.drops_empty_taps = true, .widens = true}}),
      options_(parts),
      image_(options.extent),
      scratch_(options.extent),
      known_(options.extent) {
  parts.validate();
}

void Svgf::blend_tile(const Tile& tile) {
  BasisField& field = bases();
  const auto& u = frame().lights[0].radiance;
  for_each_sample(tile, [&](int x, int y, bool usable) {
    if (!usable) return;
    float& frames = field.age(x, y);
    const float even = 1.0f / (frames + 1.0f);
    const float color_share = std::max(options_.alpha, even);
    const float moment_share = std::max(options_.moments_alpha, even);
    const auto blend = [](float& kept, float now, float share) { kept += (now - kept) * share; };
    for (int c = 0; c < 3; ++c) {
      blend(field.value(x, y, c, 0), u[static_cast<std::size_t>(c)](x, y), color_share);
    }
    const float l = 0.2126f * u[0](x, y) + 0.7152f * u[1](x, y) + 0.0722f * u[2](x, y);
    blend(field.value(x, y, 0, 1), l, moment_share);
    blend(field.value(x, y, 1, 1), l * l, moment_share);
    frames = std::min(frames + 1.0f, kMostFrames);
  });
}

const Planes<3>& Svgf::finish() {
  for_each_tile(tiles(), [&](const Tile& tile) { estimate(tile); });
  for (int pass = 0; pass < options_.passes; ++pass) {
    for_each_tile(tiles(), [&](const Tile& tile) {
      svgf_pass_tile({frame(), options_.weights, 1 << pass, known_}, image_, tile, scratch_);
    });
    std::swap(image_, scratch_);
    if (pass + 1 != options_.feedback) continue;
    for_each_tile(tiles(), [&](const Tile& tile) { feed_back(tile); });
  }
  return image_.color;
}

void Svgf::estimate(const Tile& tile) {
  const BasisField& field = bases();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool old = age()(x, y) >= kYoung;
      known_(x, y) = old ? 1.0f : 0.0f;
      for (int c = 0; c < 3; ++c) {
        image_.color[static_cast<std::size_t>(c)](x, y) = old ? field.value(x, y, c, 0) : 0.0f;
      }
      const float mean = field.value(x, y, 0, 1);
      image_.variance(x, y) = old ? std::max(0.0f, field.value(x, y, 1, 1) - mean * mean) : 0.0f;
      if (!old && frame().surface.id(x, y) != 0) estimate_from_window({x, y});
    }
  }
}

void Svgf::estimate_from_window(glm::ivec2 p) {
  constexpr int kRadius = 3;
  const BasisField& field = bases();
  std::array<double, 5> sum{};
  double weights = 0.0;
  for (int y = p.y - kRadius; y <= p.y + kRadius; ++y) {
    for (int x = p.x - kRadius; x <= p.x + kRadius; ++x) {
      if (!field.extent().contains(x, y) || !(field.age(x, y) > 0.0f)) continue;
      const double w = static_cast<double>(
          p == glm::ivec2(x, y) ? 1.0f
                                : svgf_geometry_weight(frame(), options_.weights, p, {x, y}));
      weights += w;
      for (int c = 0; c < 3; ++c) {
        sum[static_cast<std::size_t>(c)] += w * static_cast<double>(field.value(x, y, c, 0));
      }
      for (int m = 0; m < 2; ++m) {
        sum[static_cast<std::size_t>(3 + m)] += w * static_cast<double>(field.value(x, y, m, 1));
      }
    }
  }
  if (!(weights > 0.0)) return;
  for (std::size_t c = 0; c < 3; ++c) {
    image_.color[c](p.x, p.y) = static_cast<float>(sum[c] / weights);
  }
  const double mean = sum[3] / weights;
  const double boost = static_cast<double>(kYoung / std::max(age()(p.x, p.y), 1.0f));
  image_.variance(p.x, p.y) =
      static_cast<float>(boost * std::max(0.0, sum[4] / weights - mean * mean));
  known_(p.x, p.y) = 1.0f;
}

void Svgf::feed_back(const Tile& tile) {
  BasisField& field = bases();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      if (!(age()(x, y) > 0.0f)) continue;
      for (int c = 0; c < 3; ++c) {
        field.value(x, y, c, 0) = image_.color[static_cast<std::size_t>(c)](x, y);
      }
    }
  }
}

}  // namespace eigenlight
