#include "render/lights/distribution.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {
namespace {

double usable(float weight) { return std::isfinite(weight) && weight > 0.0f ? weight : 0.0; }

constexpr float kBelowOne = 0x1.fffffep-1f;

}  // namespace

Distribution::Distribution(std::span<const float> weights) {
  for (const float w : weights) total_ += usable(w);
  if (!(total_ > 0.0)) return;
  upper_.reserve(weights.size());
  double sum = 0.0;
  for (const float w : weights) {
    sum += usable(w);
    upper_.push_back(static_cast<float>(sum / total_));
  }
}

float Distribution::probability(std::size_t index) const {
  return upper_[index] - (index > 0 ? upper_[index - 1] : 0.0f);
}

Distribution::Choice Distribution::sample(float u) const {
  const auto at = std::upper_bound(upper_.begin(), upper_.end(), u);
  const auto index = static_cast<std::size_t>(at - upper_.begin());
  const float low = index > 0 ? upper_[index - 1] : 0.0f;
  const float width = upper_[index] - low;
  return {index, width, std::min((u - low) / width, kBelowOne)};
}

}  // namespace eigenlight
