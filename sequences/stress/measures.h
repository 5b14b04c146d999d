// Figures that stress cases share.
#pragma once

#include <functional>

#include "sequences/stress/lab.h"

namespace eigenlight {

/// Largest distance of a pixel from another run's, in standard deviations, that chance alone makes:
/// a case compares some ten million values, and of so many normal numbers the largest is 5.3.
inline constexpr double kChance = 6.0;

/// Standard deviation of the output at each pixel and channel, for every frame of a sequence.
using NoiseMaps = std::vector<Planes<3>>;

/// From four runs of other seeds, whose variances are pooled over 7 x 7 pixels (147 degrees of
/// freedom: good to 6 %).
[[nodiscard]] NoiseMaps noise_maps(Lab& lab, const AnalyticOptions& options);

/// Largest |a - b| / noise over the pixels that `counts` says yes to. NaN if any is.
[[nodiscard]] double largest_deviation(const Planes<3>& a, const Planes<3>& b,
                                       const Planes<3>& noise,
                                       const std::function<bool(int, int)>& counts);

/// Largest |a - b| / |b|; pixels where b is 0 count |a|.
[[nodiscard]] double largest_relative(const Planes<3>& a, const Planes<3>& b);

/// mean((x - truth)^2 / truth^2) over the pixels with a surface.
[[nodiscard]] double relative_error(const StressRun& run);

/// Mean of x / mean of truth - 1 over the pixels with a surface.
[[nodiscard]] double relative_bias(const StressRun& run);

/// All pixels, in a copy that outlives the run.
[[nodiscard]] Planes<3> copy_of(const Planes<3>& planes);

/// 0 if the visible pixels have the same bits, else how many differ.
[[nodiscard]] double different_pixels(const Planes<3>& a, const Planes<3>& b);

}  // namespace eigenlight
