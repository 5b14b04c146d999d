// The inner loops of the sample budget, over one row of pixels.
#pragma once

#include <array>
#include <cstdint>

namespace eigenlight {

/// Pixels by whole samples of age; those of kBudgetBins - 1 and more are one bin.
inline constexpr int kBudgetBins = 256;
using AgeHistogram = std::array<std::int64_t, kBudgetBins>;

/// Adds the pixels of a row that show a surface, by age * spp rounded to whole samples. What has
/// `oldest` samples or more goes into that bin, because no more is needed. An age that is
/// negative or NaN counts as 0.
void count_ages(const std::uint32_t* id, const float* age, int count, int spp, int oldest,
                AgeHistogram& pixels);

/// extra = max(0, level - whole samples of age), at most `most`; 0 where there is no surface.
/// Values up to two vectors behind the row are written, too, as the padding of planes allows.
void fill_up(const std::uint32_t* id, const float* age, int count, int spp, int level, int most,
             std::uint8_t* extra);

}  // namespace eigenlight
