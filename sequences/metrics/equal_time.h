// Error against time: what is measured at some sample counts, read at one time.
#pragma once

#include <optional>
#include <vector>

namespace eigenlight {

/// One measurement of one method.
struct CurvePoint {
  double ms = 0.0;     ///< > 0: CPU time of rendering and denoising a frame
  double error = 0.0;  ///< may be <= 0, as unbiased errors may
};

/// The error of a method at time `ms`: linear in log(error) over log(time) between the two measured
/// points next to it, in any order given. Nothing outside the measured times (never extrapolated),
/// nor beside a point whose time or error is not above 0, since such a point has no place in
/// log-log.
[[nodiscard]] std::optional<double> error_at_time(std::vector<CurvePoint> points, double ms);

/// Which points no other point beats: none is both as fast and as good, and better in one of the
/// two. Points that are equal stand or fall together.
[[nodiscard]] std::vector<bool> pareto_front(const std::vector<CurvePoint>& points);

}  // namespace eigenlight
