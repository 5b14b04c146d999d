// Stateless low-discrepancy samples.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace eigenlight {

/// Random numbers of one sample of one pixel: an Owen-scrambled Sobol (0,2)-sequence in each pair
/// of dimensions, with the sample order shuffled per pair (Burley, Practical Hash-based Owen
/// Scrambling, JCGT 9(4), 2020). Samples 0, 1, 2, ... of one key are stratified, best for powers of
/// two. Different keys are independent.
class Sampler {
 public:
  /// `key` is a hash of pixel, frame and seed; `index` is the number of the sample.
  Sampler(std::uint32_t key, std::uint32_t index);

  /// The next pair of dimensions, in [0, 1)^2.
  [[nodiscard]] glm::vec2 next_2d();
  /// One dimension of the next pair.
  [[nodiscard]] float next_1d();

 private:
  [[nodiscard]] std::uint32_t next_index(std::uint32_t& seed);

  std::uint32_t key_;
  std::uint32_t reversed_index_;
};

}  // namespace eigenlight
