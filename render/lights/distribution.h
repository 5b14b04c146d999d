// Choosing one of many with given chances.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace eigenlight {

/// Rec. 709 luminance of a linear color.
[[nodiscard]] inline float luminance(const glm::vec3& color) {
  return glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

/// Indices 0..n-1 with chances in proportion to weights, by inversion: neighbors in u are neighbors
/// in index, so well-spread u stay well spread. Weights that are negative, NaN or Inf count as 0.
class Distribution {
 public:
  Distribution() = default;
  explicit Distribution(std::span<const float> weights);

  /// Sum of the weights; 0: nothing can be chosen.
  [[nodiscard]] double total() const { return total_; }
  [[nodiscard]] std::size_t size() const { return upper_.size(); }

  struct Choice {
    std::size_t index = 0;
    float chance = 0.0f;
    float remainder = 0.0f;  ///< u, stretched over the chosen index: uniform in [0, 1) again
  };
  /// `u` in [0, 1). Requires total() > 0.
  [[nodiscard]] Choice sample(float u) const;
  [[nodiscard]] float chance(std::size_t index) const;

 private:
  std::vector<float> upper_;  // running sums over the total; the last one with a weight is 1
  double total_ = 0.0;
};

}  // namespace eigenlight
