#include "sequences/metrics/equal_time.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {

std::optional<double> error_at_time(std::vector<CurvePoint> points, double ms) {
  std::sort(points.begin(), points.end(),
            [](const CurvePoint& a, const CurvePoint& b) { return a.ms < b.ms; });
  const auto after = std::lower_bound(points.begin(), points.end(), ms,
                                      [](const CurvePoint& p, double time) { return p.ms < time; });
  if (after == points.end()) return std::nullopt;
  const auto usable = [](const CurvePoint& p) { return p.ms > 0.0 && p.error > 0.0; };
  if (!usable(*after)) return std::nullopt;
  if (after->ms == ms) return after->error;
  if (after == points.begin()) return std::nullopt;
  const CurvePoint& before = *(after - 1);
  if (!usable(before)) return std::nullopt;
  const double share = std::log(ms / before.ms) / std::log(after->ms / before.ms);
  return before.error * std::pow(after->error / before.error, share);
}

std::vector<bool> pareto_front(const std::vector<CurvePoint>& points) {
  const auto beats = [](const CurvePoint& a, const CurvePoint& b) {
    return a.ms <= b.ms && a.error <= b.error && (a.ms < b.ms || a.error < b.error);
  };
  std::vector<bool> front;
  for (const CurvePoint& point : points) {
    front.push_back(std::none_of(points.begin(), points.end(),
                                 [&](const CurvePoint& other) { return beats(other, point); }));
  }
  return front;
}

}  // namespace eigenlight
