// Figures shared by stress cases.
#pragma once

#include <functional>

#include "sequences/stress/stress_run.h"

namespace eigenlight {

/// Largest distance between pixels of two runs, in standard deviations, that chance explains: a
/// case compares some ten million values, and the largest of ten million normal numbers is 5.3.
inline constexpr double kChance = 6.0;

/// Standard deviation of the output at each pixel and channel, for each frame of a sequence.
using NoiseMaps = std::vector<Planes<3>>;

/// Measured from four runs with other seeds; variances are pooled over 7 x 7 pixels (147 degrees of
/// freedom: exact to 6 %).
[[nodiscard]] NoiseMaps noise_maps(StressLog& log, const AnalyticOptions& options);

/// Largest |a - b| / noise over the pixels for which `counts` is true. NaN if any of them is NaN.
[[nodiscard]] double largest_deviation(const Planes<3>& a, const Planes<3>& b,
                                       const Planes<3>& noise,
                                       const std::function<bool(int, int)>& counts);

/// Largest |a - b| / |b|, or |a| where b is 0.
[[nodiscard]] double largest_relative(const Planes<3>& a, const Planes<3>& b);

/// mean((x - truth)^2 / truth^2) over the pixels with a surface.
[[nodiscard]] double relative_error(const StressRun& run);

/// Mean of x / mean of truth - 1 over the pixels with a surface.
[[nodiscard]] double relative_bias(const StressRun& run);

/// A copy that outlives the run.
[[nodiscard]] Planes<3> copy_of(const Planes<3>& planes);

/// The number of values whose bits differ.
[[nodiscard]] double different_pixels(const Planes<3>& a, const Planes<3>& b);

}  // namespace eigenlight
