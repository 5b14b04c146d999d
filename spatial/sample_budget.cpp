#include "spatial/sample_budget.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {
namespace {

// Age in whole samples, saturated to the last bin. To the nearest, because most ages are whole
// numbers but for the rounding of their warp, and must not lose a sample to it.
int age_samples(float age, int spp) {
  // No age is negative or NaN, but as an index it would reach beyond the histogram.
  if (!std::isgreater(age, 0.0f)) return 0;
  return static_cast<int>(std::min(age * static_cast<float>(spp) + 0.5f, 255.0f));
}

}  // namespace

void BudgetOptions::validate() const {
  EL_CHECK(share >= 0.0 && share <= 100.0, "budget share {}: expected [0, 100]", share);
  EL_CHECK(most_per_pixel >= 0 && most_per_pixel <= 255, "most_per_pixel {}: expected [0, 255]",
           most_per_pixel);
  EL_CHECK(enough >= 1.0f && enough <= 255.0f, "enough {}: expected [1, 255] frames", enough);
}

SampleBudget::SampleBudget(Extent extent, const BudgetOptions& options)
    : options_(options),
      grid_(stage_tiles(extent)),
      histograms_(static_cast<std::size_t>(grid_.count())) {
  options.validate();
}

int SampleBudget::find_level(const Histogram& pixels, std::int64_t limit, int spp) const {
  const int highest =
      std::min(255, static_cast<int>((options_.enough - 1.0f) * static_cast<float>(spp)));
  const auto cost = [&](int level) {
    std::int64_t sum = 0;
    for (int age = 0; age < level; ++age) {
      sum += pixels[static_cast<std::size_t>(age)] * std::min(level - age, options_.most_per_pixel);
    }
    return sum;
  };
  int level = 0;
  while (level < highest && cost(level + 1) <= limit) ++level;
  return level;
}

BudgetStats SampleBudget::process(const Frame& frame, const Plane<float>& age,
                                  Plane<std::uint8_t>& extra) {
  EL_CHECK(frame.extent() == grid_.extent() && age.extent() == grid_.extent() &&
               extra.extent() == grid_.extent(),
           "sample budget made for {}x{}: got planes of another size", grid_.extent().width,
           grid_.extent().height);
  for_each_tile(grid_, [&](const Tile& tile) {
    Histogram& histogram = histograms_[static_cast<std::size_t>(tile.index)];
    histogram.fill(0);
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        if (frame.surface.id(x, y) == 0) continue;
        ++histogram[static_cast<std::size_t>(age_samples(age(x, y), frame.spp))];
      }
    }
  });
  Histogram pixels{};
  for (const Histogram& h : histograms_) {
    std::transform(h.begin(), h.end(), pixels.begin(), pixels.begin(), std::plus<>());
  }
  std::int64_t surface = 0;
  for (const std::int64_t n : pixels) surface += n;
  const auto limit =
      static_cast<std::int64_t>(options_.share * frame.spp * static_cast<double>(surface));
  const int level = find_level(pixels, limit, frame.spp);

  BudgetStats stats;
  stats.level = 1.0f + static_cast<float>(level) / static_cast<float>(std::max(frame.spp, 1));
  for (int a = 0; a < level; ++a) {
    const std::int64_t count = pixels[static_cast<std::size_t>(a)];
    stats.samples += count * std::min(level - a, options_.most_per_pixel);
    stats.pixels += count;
  }
  for_each_tile(grid_, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const int missing =
            frame.surface.id(x, y) == 0 ? 0 : level - age_samples(age(x, y), frame.spp);
        extra(x, y) = static_cast<std::uint8_t>(std::clamp(missing, 0, options_.most_per_pixel));
      }
    }
  });
  return stats;
}

}  // namespace eigenlight
