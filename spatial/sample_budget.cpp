#include "spatial/sample_budget.h"

#include <algorithm>
#include <functional>

namespace eigenlight {
namespace {

// Rows of a strip: few enough for many threads, enough that adding histograms takes little time.
constexpr int kRows = 16;

}  // namespace

void BudgetOptions::validate() const {
  EL_CHECK(share >= 0.0 && share <= 100.0, "budget share {}: expected [0, 100]", share);
  EL_CHECK(most_per_pixel >= 0 && most_per_pixel <= 255, "most_per_pixel {}: expected [0, 255]",
           most_per_pixel);
  EL_CHECK(enough >= 1.0f && enough <= 255.0f, "enough {}: expected [1, 255] frames", enough);
}

SampleBudget::SampleBudget(Extent extent, const BudgetOptions& options)
    : options_(options), grid_(extent, extent.width, kRows), histograms_(grid_) {
  options.validate();
}

int SampleBudget::highest(int spp) const {
  return std::min(kBudgetBins - 1,
                  static_cast<int>((options_.enough - 1.0f) * static_cast<float>(spp)));
}

int SampleBudget::find_level(const AgeHistogram& pixels, std::int64_t limit, int spp) const {
  const auto cost = [&](int level) {
    std::int64_t sum = 0;
    for (int age = 0; age < level; ++age) {
      sum += pixels[static_cast<std::size_t>(age)] * std::min(level - age, options_.most_per_pixel);
    }
    return sum;
  };
  int level = 0;
  while (level < highest(spp) && cost(level + 1) <= limit) ++level;
  return level;
}

BudgetStats SampleBudget::process(const FrameInput& frame, const Plane<float>& age,
                                  Plane<std::uint8_t>& extra) {
  EL_CHECK(frame.extent() == grid_.extent() && age.extent() == grid_.extent() &&
               extra.extent() == grid_.extent(),
           "sample budget made for {}x{}: got planes of another size", grid_.extent().width,
           grid_.extent().height);
  for_each_tile(grid_, [&](const Tile& rows) {
    AgeHistogram& histogram = histograms_[rows];
    histogram.fill(0);
    for (int y = rows.y0; y < rows.y1; ++y) {
      count_ages(frame.surface.id.row(y), age.row(y), rows.x1, frame.spp, highest(frame.spp),
                 histogram);
    }
  });
  AgeHistogram pixels{};
  for (const AgeHistogram& h : histograms_) {
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
  for_each_tile(grid_, [&](const Tile& rows) {
    for (int y = rows.y0; y < rows.y1; ++y) {
      fill_up(frame.surface.id.row(y), age.row(y), rows.x1, frame.spp, level,
              options_.most_per_pixel, extra.row(y));
    }
  });
  return stats;
}

}  // namespace eigenlight
