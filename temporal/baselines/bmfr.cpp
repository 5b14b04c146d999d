#include "temporal/baselines/bmfr.h"

#include <algorithm>
#include <cmath>

#include "temporal/baselines/bmfr_fit.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::uint32_t kStateVersion = 2;
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
    : options_(parts),
      tiles_(stage_tiles(options.extent)),
      history_(options.extent, 2, {.drops_empty_taps = true}),
      light_(make_planes<3>(options.extent)),
      output_(make_planes<3>(options.extent)),
      age_(options.extent),
      counts_(static_cast<std::size_t>(tiles_.count())) {
  parts.validate();
}

const Planes<3>* Bmfr::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const BasisHistory::Warp warp = history_.warp(frame_);
  report_[Stage::kReproject] = clock.lap();
  for_each_tile(tiles_, [&](const Tile& tile) {
    accumulate(tile, counts_[static_cast<std::size_t>(tile.index)]);
  });
  report_[Stage::kUpdate] = clock.lap();
  const int jitter = (frame_.index % kOffsets + kOffsets) % kOffsets;
  bmfr_fit({frame_, light_, age_, jitter, options_.noise}, output_);
  for_each_tile(tiles_, [&](const Tile& tile) { blend_fit(tile); });
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
  return &output_;
}

void Bmfr::accumulate(const Tile& tile, Counts& counts) {
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
      const bool usable = surface && finite;
      const float share = usable ? std::max(options_.alpha, 1.0f / (age + 1.0f)) : 0.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        float& kept = field.value(x, y, static_cast<int>(c), 0);
        if (usable) kept += (u[c](x, y) - kept) * share;
        light_[c](x, y) = kept;
      }
      if (usable) age = std::min(age + 1.0f, kMostFrames);
      age_(x, y) = age;
    }
  }
}

void Bmfr::blend_fit(const Tile& tile) {
  BasisField& field = history_.bases();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float age = age_(x, y);
      // Without a sample yet: the fit alone, of which nothing is kept.
      if (!(age > 0.0f)) continue;
      const float share = std::max(options_.second_alpha, 1.0f / age);
      for (std::size_t c = 0; c < 3; ++c) {
        float& kept = field.value(x, y, static_cast<int>(c), 1);
        kept += (output_[c](x, y) - kept) * share;
        output_[c](x, y) = kept;
      }
    }
  }
}

void Bmfr::save(StateWriter& out) const {
  out.value("bmfr", kStateVersion);
  history_.save(out);
}

void Bmfr::load(StateReader& in) {
  std::uint32_t version = 0;
  in.value("bmfr", version);
  if (version != kStateVersion) {
    throw std::runtime_error(
        fmt::format("state of 'bmfr': version {}, expected {}", version, kStateVersion));
  }
  history_.load(in);
}

}  // namespace eigenlight
