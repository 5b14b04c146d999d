#include "spatial/atrous.h"

#include <numeric>

#include "frame/luminance.h"
#include "frame/strips.h"
#include "spatial/atrous_kernel.h"

namespace eigenlight {
namespace {

const AtrousOptions& valid(const AtrousOptions& options) {
  options.validate();
  return options;
}

bool is_quiet(const Planes<3>& color, const Plane<float>& variance, float quiet, const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float l = luminance(color, x, y);
      if (variance(x, y) > quiet * l * l) return false;
    }
  }
  return true;
}

void copy_tile(const AtrousPass& pass, const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    const auto copy = [&](const Plane<float>& from, Plane<float>& to) {
      std::copy(from.at(tile.x0, y), from.row(y) + tile.x1, to.at(tile.x0, y));
    };
    for (std::size_t c = 0; c < 3; ++c) copy(pass.color[c], pass.out_color[c]);
    copy(pass.variance, pass.out_variance);
  }
}

std::int64_t surface_pixels(const FrameInput& frame, const Tile& tile) {
  std::int64_t count = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) count += frame.surface.id(x, y) != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace

void AtrousOptions::validate() const {
  EL_CHECK(passes >= 1 && passes <= 6, "passes {}: expected 1 to 6", passes);
  EL_CHECK(luminance_sigmas > 0.0f && (luminance_sigmas <= 100.0f || !looks_at_light()),
           "luminance_sigmas {}: expected (0, 100] or inf", luminance_sigmas);
  EL_CHECK(earlier_sigmas > 0.0f && earlier_sigmas <= 100.0f,
           "earlier_sigmas {}: expected (0, 100]", earlier_sigmas);
  EL_CHECK(earlier_share >= 0.0f && earlier_share <= 1.0f, "earlier_share {}: expected [0, 1]",
           earlier_share);
  EL_CHECK(plane_distance > 0.0f && plane_distance <= 1.0f,
           "plane_distance {}: expected (0, 1] of the depth", plane_distance);
}

Atrous::Atrous(Extent extent, const AtrousOptions& options)
    : options_(valid(options)),
      grid_(stage_tiles(extent)),
      planar_(extent, options.planar_tolerance()),
      scratch_color_(make_planes<3>(extent)),
      scratch_variance_(extent),
      noisy_(grid_),
      skipped_(grid_) {}

void Atrous::check(const FrameInput& guides, const Planes<3>& color, const Plane<float>& variance,
                   const Plane<float>* earlier) const {
  const Extent extent = grid_.extent();
  EL_CHECK(guides.extent() == extent && color[0].extent() == extent &&
               variance.extent() == extent && (earlier == nullptr || earlier->extent() == extent),
           "a-trous filter made for {}x{}: got planes of another size", extent.width,
           extent.height);
}

void Atrous::find_planes(const FrameInput& guides, const PerTile<std::uint8_t>& wanted) {
  if (options_.skip_planar) {
    planar_.find(guides, wanted);
  } else {
    planar_.clear();
  }
}

void Atrous::run_pass(const Pass& in, int pass, Planes<3>& color, Plane<float>& variance) {
  const AtrousPass work{in.guides, options_,   in.planes,      1 << pass,        color,
                        variance,  in.earlier, scratch_color_, scratch_variance_};
  const auto is_wanted = [&](const Tile& tile) { return in.wanted[tile] != 0; };
  for_each_strip(grid_, [&](const Strip& strip) {
    // Neighboring tiles that are all wanted, or all not, are processed as one.
    Tile area = grid_.tile(strip.area.index);
    bool filtered = is_wanted(area);
    const auto run = [&] { filtered ? atrous_tile(work, area) : copy_tile(work, area); };
    for (int i = 1; i < strip.tiles; ++i) {
      const Tile tile = grid_.tile(strip.area.index + i);
      const bool next = is_wanted(tile);
      if (next != filtered) {
        run();
        area = tile;
      }
      area.x1 = tile.x1;
      filtered = next;
    }
    run();
  });
  std::swap(color, scratch_color_);
  std::swap(variance, scratch_variance_);
}

const PerTile<std::uint8_t>& Atrous::find_noisy(const FrameInput& guides, float quiet,
                                                const Planes<3>& color,
                                                const Plane<float>& variance) {
  check(guides, color, variance, nullptr);
  for_each_tile(grid_, [&](const Tile& tile) {
    const std::int64_t surface = surface_pixels(guides, tile);
    const bool noisy = surface > 0 && !is_quiet(color, variance, quiet, tile);
    noisy_[tile] = noisy ? 1 : 0;
    skipped_[tile] = noisy ? 0 : surface;
  });
  return noisy_;
}

std::int64_t Atrous::filter_noisy(const FrameInput& guides, const PlanarBlocks& planes, float quiet,
                                  Planes<3>& color, Plane<float>& variance,
                                  const Plane<float>* earlier) {
  check(guides, color, variance, earlier);
  const Pass work{guides, planes, noisy_, earlier};
  run_pass(work, 0, color, variance);
  for (int pass = 1; pass < options_.passes; ++pass) {
    for_each_tile(grid_, [&](const Tile& tile) {
      std::uint8_t& noisy = noisy_[tile];
      if (noisy != 0 && is_quiet(color, variance, quiet, tile)) noisy = 0;
    });
    run_pass(work, pass, color, variance);
  }
  return std::accumulate(skipped_.begin(), skipped_.end(), std::int64_t{0});
}

std::int64_t Atrous::process(const FrameInput& guides, float quiet, Planes<3>& color,
                             Plane<float>& variance, const Plane<float>* earlier) {
  find_planes(guides, find_noisy(guides, quiet, color, variance));
  return filter_noisy(guides, planar_, quiet, color, variance, earlier);
}

void Atrous::process(const FrameInput& guides, const PerTile<std::uint8_t>& wanted,
                     Planes<3>& color, Plane<float>& variance) {
  check(guides, color, variance, nullptr);
  EL_CHECK(wanted.size() == grid_.count(), "{} wanted flags for {} tiles", wanted.size(),
           grid_.count());
  find_planes(guides, wanted);
  for (int pass = 0; pass < options_.passes; ++pass) {
    run_pass({guides, planar_, wanted, nullptr}, pass, color, variance);
  }
}

}  // namespace eigenlight
