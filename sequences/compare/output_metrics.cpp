#include "sequences/compare/output_metrics.h"

#include <cmath>
#include <utility>

namespace eigenlight {
namespace {

bool is_finite(const Planes<3>& planes, int x, int y) {
  return std::isfinite(planes[0](x, y)) && std::isfinite(planes[1](x, y)) &&
         std::isfinite(planes[2](x, y));
}

Planes<3> clone(const Planes<3>& planes) {
  return {planes[0].clone(), planes[1].clone(), planes[2].clone()};
}

}  // namespace

Plane<std::uint8_t> surface_bits(const Plane<std::uint32_t>& id, const Plane<float>& age) {
  Plane<std::uint8_t> bits(id.extent());
  for (int y = 0; y < bits.height(); ++y) {
    for (int x = 0; x < bits.width(); ++x) {
      if (id(x, y) == 0) continue;
      bits(x, y) =
          static_cast<std::uint8_t>(kSurfaceBit | (age(x, y) < kYoungAge ? kYoungBit : kOldBit));
    }
  }
  return bits;
}

void OutputMetrics::add(const ReferenceFrame& references, Planes<3> test, Planes<3> second) {
  MetricFrame frame;
  frame.frame = references.frame;
  frame.follows = !frames_.empty() && frames_.back().frame + 1 == references.frame;
  frame.bits = references.bits.clone();
  for (int y = 0; y < frame.bits.height(); ++y) {
    for (int x = 0; x < frame.bits.width(); ++x) {
      const bool is_good = is_finite(test, x, y) && (second[0].empty() || is_finite(second, x, y));
      if (!is_good && (references.bits(x, y) & kSurfaceBit)) ++bad_pixels_;
      if (!is_good || !is_finite(references.a, x, y) || !is_finite(references.b, x, y)) continue;
      frame.bits(x, y) = static_cast<std::uint8_t>(frame.bits(x, y) | kFiniteBit);
    }
  }
  frame.test = std::move(test);
  frame.test_b = std::move(second);
  frame.reference = clone(references.a);
  frame.reference_b = clone(references.b);
  frames_.push_back(metrics_.add(std::move(frame)));
}

}  // namespace eigenlight
