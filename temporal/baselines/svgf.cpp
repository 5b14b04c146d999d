#include "temporal/baselines/svgf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::uint32_t kStateVersion = 2;

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
    : options_(parts),
      tiles_(stage_tiles(options.extent)),
      history_(options.extent, 2, {.drops_empty_taps = true, .widens = true}),
      image_(options.extent),
      scratch_(options.extent),
      age_(options.extent),
      known_(options.extent),
      counts_(static_cast<std::size_t>(tiles_.count())) {
  parts.validate();
}

const Planes<3>* Svgf::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const BasisHistory::Warp warp = history_.warp(frame_);
  report_[Stage::kReproject] = clock.lap();
  for_each_tile(tiles_, [&](const Tile& tile) {
    accumulate(tile, counts_[static_cast<std::size_t>(tile.index)]);
  });
  for_each_tile(tiles_, [&](const Tile& tile) { estimate(tile); });
  report_[Stage::kUpdate] = clock.lap();
  filter();
  history_.keep(frame_);
  report_[Stage::kFilter] = clock.lap();

  report_.frame = frame_.index;
  report_.cut = warp.cut;
  report_.skipped_warp = warp.skipped;
  for (const Counts& counts : counts_) {
    report_.surface_pixels += counts.surface;
    report_.new_pixels += counts.fresh;
    report_.non_finite_pixels += counts.non_finite;
  }
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &image_.color;
}

void Svgf::accumulate(const Tile& tile, Counts& counts) {
  BasisField& field = history_.bases();
  const auto& u = frame_.indirect;
  counts = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool surface = frame_.surface.id(x, y) != 0;
      const bool finite =
          std::isfinite(u[0](x, y)) && std::isfinite(u[1](x, y)) && std::isfinite(u[2](x, y));
      float& age = field.age(x, y);
      counts.surface += surface ? 1 : 0;
      counts.fresh += surface && age == 0.0f ? 1 : 0;
      counts.non_finite += surface && !finite ? 1 : 0;
      if (surface && finite) {
        const float even = 1.0f / (age + 1.0f);
        const float color_share = std::max(options_.alpha, even);
        const float moment_share = std::max(options_.moments_alpha, even);
        const auto blend = [](float& kept, float now, float share) {
          kept += (now - kept) * share;
        };
        for (int c = 0; c < 3; ++c) {
          blend(field.value(x, y, c, 0), u[static_cast<std::size_t>(c)](x, y), color_share);
        }
        const float l = 0.2126f * u[0](x, y) + 0.7152f * u[1](x, y) + 0.0722f * u[2](x, y);
        blend(field.value(x, y, 0, 1), l, moment_share);
        blend(field.value(x, y, 1, 1), l * l, moment_share);
        age = std::min(age + 1.0f, kMostFrames);
      }
      age_(x, y) = age;
    }
  }
}

void Svgf::estimate(const Tile& tile) {
  const BasisField& field = history_.bases();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool old = age_(x, y) >= kYoung;
      known_(x, y) = old ? 1.0f : 0.0f;
      for (int c = 0; c < 3; ++c) {
        image_.color[static_cast<std::size_t>(c)](x, y) = old ? field.value(x, y, c, 0) : 0.0f;
      }
      const float mean = field.value(x, y, 0, 1);
      image_.variance(x, y) = old ? std::max(0.0f, field.value(x, y, 1, 1) - mean * mean) : 0.0f;
      if (!old && frame_.surface.id(x, y) != 0) estimate_from_window({x, y});
    }
  }
}

void Svgf::estimate_from_window(glm::ivec2 p) {
  constexpr int kRadius = 3;
  const BasisField& field = history_.bases();
  std::array<double, 5> sum{};
  double weights = 0.0;
  for (int y = p.y - kRadius; y <= p.y + kRadius; ++y) {
    for (int x = p.x - kRadius; x <= p.x + kRadius; ++x) {
      if (!field.extent().contains(x, y) || !(field.age(x, y) > 0.0f)) continue;
      const double w = static_cast<double>(
          p == glm::ivec2(x, y) ? 1.0f : svgf_geometry_weight(frame_, options_.weights, p, {x, y}));
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
  const double boost = static_cast<double>(kYoung / std::max(age_(p.x, p.y), 1.0f));
  image_.variance(p.x, p.y) =
      static_cast<float>(boost * std::max(0.0, sum[4] / weights - mean * mean));
  known_(p.x, p.y) = 1.0f;
}

void Svgf::filter() {
  for (int pass = 0; pass < options_.passes; ++pass) {
    for_each_tile(tiles_, [&](const Tile& tile) {
      svgf_pass_tile({frame_, options_.weights, 1 << pass, known_}, image_, tile, scratch_);
    });
    std::swap(image_, scratch_);
    if (pass + 1 != options_.feedback) continue;
    for_each_tile(tiles_, [&](const Tile& tile) { feed_back(tile); });
  }
}

void Svgf::feed_back(const Tile& tile) {
  BasisField& field = history_.bases();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      if (!(age_(x, y) > 0.0f)) continue;
      for (int c = 0; c < 3; ++c) {
        field.value(x, y, c, 0) = image_.color[static_cast<std::size_t>(c)](x, y);
      }
    }
  }
}

void Svgf::save(StateWriter& out) const {
  out.value("svgf", kStateVersion);
  history_.save(out);
}

void Svgf::load(StateReader& in) {
  std::uint32_t version = 0;
  in.value("svgf", version);
  if (version != kStateVersion) {
    throw std::runtime_error(
        fmt::format("state of 'svgf': version {}, expected {}", version, kStateVersion));
  }
  history_.load(in);
}

}  // namespace eigenlight
