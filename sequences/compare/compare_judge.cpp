#include "sequences/compare/compare_judge.h"

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

void Judge::add(const JudgedFrame& truth, Planes<3> test) {
  MetricFrame frame;
  frame.frame = truth.frame;
  frame.follows = !frames_.empty() && frames_.back().frame + 1 == truth.frame;
  frame.bits = truth.bits.clone();
  for (int y = 0; y < frame.bits.height(); ++y) {
    for (int x = 0; x < frame.bits.width(); ++x) {
      const bool is_good = is_finite(test, x, y);
      if (!is_good && (truth.bits(x, y) & kSurfaceBit)) ++bad_pixels_;
      if (!is_good || !is_finite(truth.a, x, y) || !is_finite(truth.b, x, y)) continue;
      frame.bits(x, y) = static_cast<std::uint8_t>(frame.bits(x, y) | kFiniteBit);
    }
  }
  frame.test = std::move(test);
  frame.reference = clone(truth.a);
  frame.reference_b = clone(truth.b);
  frames_.push_back(metrics_.add(std::move(frame)));
}

}  // namespace eigenlight
