// Discrete distribution over indices.
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

/// Samples indices 0..n-1 with probabilities proportional to weights, by inversion of the
/// cumulative sum, which keeps stratified numbers stratified. Weights that are negative, NaN or Inf
/// count as 0.
class Distribution {
 public:
  Distribution() = default;
  explicit Distribution(std::span<const float> weights);

  /// Sum of the weights; 0 if no index can be sampled.
  [[nodiscard]] double total() const { return total_; }
  [[nodiscard]] std::size_t size() const { return upper_.size(); }

  struct Choice {
    std::size_t index = 0;
    float probability = 0.0f;
    float remainder = 0.0f;  ///< position of u within the index; uniform in [0, 1)
  };
  /// `u` in [0, 1). Requires total() > 0.
  [[nodiscard]] Choice sample(float u) const;
  [[nodiscard]] float probability(std::size_t index) const;

 private:
  std::vector<float> upper_;  // cumulative sums divided by the total; 1 from the last weight on
  double total_ = 0.0;
};

}  // namespace eigenlight
