#include "spatial/atrous.h"

#include <array>
#include <numeric>

#include "frame/luminance.h"
#include "frame/strips.h"
#include "spatial/atrous_kernel.h"

namespace eigenlight {
namespace {

constexpr std::uint8_t kAll = 0xff;

std::uint8_t bit(std::size_t image) { return static_cast<std::uint8_t>(1u << image); }

AtrousWork work_of(const AtrousImage& image, Planes<3>& out_color, Plane<float>& out_variance) {
  return {&image.color, &image.variance, image.earlier, &out_color, &out_variance};
}

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

void copy_tile(const AtrousWork& work, const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    const auto copy = [&](const Plane<float>& from, Plane<float>& to) {
      std::copy(from.at(tile.x0, y), from.row(y) + tile.x1, to.at(tile.x0, y));
    };
    for (std::size_t c = 0; c < 3; ++c) copy((*work.color)[c], (*work.out_color)[c]);
    copy(*work.variance, *work.out_variance);
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

Atrous::Atrous(Extent extent, const AtrousOptions& options, int images)
    : options_(valid(options)),
      grid_(stage_tiles(extent)),
      wanted_(grid_),
      same_(grid_),
      joined_(grid_),
      skipped_(grid_) {
  EL_CHECK(images >= 1 && images <= kMostImages, "images {}: expected 1 to {}", images,
           kMostImages);
  for (int i = 0; i < images; ++i) {
    scratch_.push_back({make_planes<3>(extent), Plane<float>(extent)});
    planar_.emplace_back(extent, options.planar_tolerance());
  }
}

void Atrous::check(const FrameInput& guides, std::span<const AtrousImage> images) const {
  EL_CHECK(!images.empty() && images.size() <= scratch_.size(),
           "a-trous filter made for {} images: got {}", scratch_.size(), images.size());
  const Extent extent = grid_.extent();
  const bool looks_back = images.front().earlier != nullptr;
  for (const AtrousImage& image : images) {
    const bool fits = guides.extent() == extent && image.color[0].extent() == extent &&
                      image.variance.extent() == extent &&
                      (image.earlier == nullptr || image.earlier->extent() == extent);
    EL_CHECK(fits, "a-trous filter made for {}x{}: got planes of another size", extent.width,
             extent.height);
    EL_CHECK((image.earlier != nullptr) == looks_back,
             "a-trous filter: some images have an earlier picture, others have none");
  }
}

void Atrous::find_planes(const FrameInput& guides, const PerTile<std::uint8_t>& wanted,
                         std::size_t image) {
  if (options_.skip_planar) {
    planar_[image].find(guides, wanted);
  } else {
    planar_[image].clear();
  }
}

// Tiles in which an image is not quiet. Returns the surface pixels of the others.
std::int64_t Atrous::find_noisy(const FrameInput& guides, float quiet,
                                std::span<const AtrousImage> images) {
  for_each_tile(grid_, [&](const Tile& tile) {
    const std::int64_t surface = surface_pixels(guides, tile);
    wanted_[tile] = 0;
    skipped_[tile] = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (surface > 0 && !is_quiet(images[i].color, images[i].variance, quiet, tile)) {
        wanted_[tile] |= bit(i);
      } else {
        skipped_[tile] += surface;
      }
    }
  });
  return std::accumulate(skipped_.begin(), skipped_.end(), std::int64_t{0});
}

// What a pass has made quiet the next one copies.
void Atrous::forget_quiet(float quiet, std::span<const AtrousImage> images) {
  for_each_tile(grid_, [&](const Tile& tile) {
    for (std::size_t i = 0; i < images.size(); ++i) {
      const bool noisy = (wanted_[tile] & bit(i)) != 0;
      if (noisy && is_quiet(images[i].color, images[i].variance, quiet, tile)) {
        wanted_[tile] ^= bit(i);
      }
    }
  });
}

// Filters some images of an area together.
void Atrous::run_images(int pass, std::span<const Job> jobs, const Tile& area,
                        std::uint8_t images) {
  std::array<AtrousWork, kMostImages> chosen;
  std::size_t count = 0;
  const Job* first = nullptr;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if ((images & bit(i)) == 0) continue;
    if (first == nullptr) first = &jobs[i];
    chosen[count++] = work_of(jobs[i].image, scratch_[i].color, scratch_[i].variance);
  }
  if (count == 0) return;
  atrous_tile({first->guides, options_, first->planar, 1 << pass, std::span(chosen).first(count)},
              area);
}

// Those that share their weights of geometry come together, others one by one.
void Atrous::run_area(int pass, std::span<const Job> jobs, const Tile& area) {
  const std::uint8_t wanted = wanted_[area], joined = joined_[area];
  run_images(pass, jobs, area, wanted & joined);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if ((wanted & bit(i)) == 0) {
      copy_tile(work_of(jobs[i].image, scratch_[i].color, scratch_[i].variance), area);
    } else if ((joined & bit(i)) == 0) {
      run_images(pass, jobs, area, bit(i));
    }
  }
}

void Atrous::run_pass(int pass, std::span<const Job> jobs) {
  for_each_strip(grid_, [&](const Strip& strip) {
    // Neighboring tiles in which the same images are wanted and joined are processed as one.
    Tile area = grid_.tile(strip.area.index);
    for (int i = 1; i < strip.tiles; ++i) {
      const Tile tile = grid_.tile(strip.area.index + i);
      if (wanted_[tile] != wanted_[area] || joined_[tile] != joined_[area]) {
        run_area(pass, jobs, area);
        area = tile;
      }
      area.x1 = tile.x1;
    }
    run_area(pass, jobs, area);
  });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    std::swap(jobs[i].image.color, scratch_[i].color);
    std::swap(jobs[i].image.variance, scratch_[i].variance);
  }
}

std::int64_t Atrous::process(const FrameInput& guides, float quiet,
                             std::span<const AtrousImage> images) {
  check(guides, images);
  const std::int64_t skipped = find_noisy(guides, quiet, images);
  find_planes(guides, wanted_, 0);
  joined_.fill(kAll);
  std::vector<Job> jobs;
  for (const AtrousImage& image : images) jobs.push_back({guides, planar_.front(), image});
  for (int pass = 0; pass < options_.passes; ++pass) {
    if (pass > 0) forget_quiet(quiet, images);
    run_pass(pass, jobs);
  }
  return skipped;
}

std::int64_t Atrous::process(const FrameInput& guides, float quiet, Planes<3>& color,
                             Plane<float>& variance, const Plane<float>* earlier) {
  return process(guides, quiet, std::array{AtrousImage{color, variance, earlier}});
}

}  // namespace eigenlight
