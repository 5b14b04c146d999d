// Weights of the pyramid filter: what each pass takes of its finer and its coarser samples.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace eigenlight {

/// The 19 numbers of one upsampling pass (Xu et al. 2024, Table 1). Samples in row order, the
/// offset (-1, -1) first: index 3 (i_y + 1) + i_x + 1.
struct PyramidPass {
  std::array<float, 9> fine{};    ///< >= 0, w_f^Omega(i, level)
  std::array<float, 9> coarse{};  ///< >= 0, w_c^Omega(i, level + 1); far ones, whose w_d is small,
                                  ///< may exceed 1
  float gamma = 1.0f;             ///< [0, 1] exponent of the range function of coarser samples
};

/// Pass l, at index l, leads from level l + 1 to level l; level 0 is the image.
using PyramidWeights = std::vector<PyramidPass>;

/// Radii that tables are made for: 1, 2, 4 .. 64 pixels; log2 of the radius is the index.
inline constexpr int kPyramidOctaves = 7;
inline constexpr float kPyramidRadius = 64.0f;  ///< largest

/// w_d(p, i) along one axis (Eq. 2f) of a pixel p with p mod 2 = `odd`, for i = `offset` in -1..1.
[[nodiscard]] constexpr float pyramid_interpolation(int odd, int offset) {
  const int distance = 4 * offset - 2 * odd + 1;
  return static_cast<float>(17 - 3 * (distance < 0 ? -distance : distance)) / 24.0f;
}

/// Passes that a domain function of `radius` needs: 1 up to radius 1, one more an octave.
[[nodiscard]] int pyramid_passes(float radius);

/// Standard deviation of the Gaussian domain function of `radius` pixels: (radius + 1) / 3, as in
/// Eq. 9, whose sigma_alpha sqrt(alpha) is the radius.
[[nodiscard]] constexpr float pyramid_sigma(float radius) { return (radius + 1.0f) / 3.0f; }

/// Scales the weights of a pass to the constraint of Eq. 2g; the filter does not change by it.
void normalize_pass(PyramidPass& pass);

/// One set of weights for each octave, and all radii between them.
class PyramidTable {
 public:
  /// `octaves`[k] has k + 1 passes, for radius 2^k. Throws std::invalid_argument otherwise, and on
  /// a negative number or a center w_f^Omega(0) of 0.
  explicit PyramidTable(std::vector<PyramidWeights> octaves);

  /// The weights of one pass for a radius in [0, 64] (others are clamped): linear in log2(radius)
  /// between octaves, linear in the radius below 1. A pass that a radius has no need for passes the
  /// finer sample through, and so does radius 0.
  [[nodiscard]] PyramidPass at(float radius, int level) const;

  /// All passes of a radius.
  [[nodiscard]] PyramidWeights weights(float radius) const;

  [[nodiscard]] const std::vector<PyramidWeights>& octaves() const { return octaves_; }

 private:
  std::vector<PyramidWeights> octaves_;
};

/// The settings of Xu et al. 2024, section 5.1(e), which need no training: gamma = 1,
/// w_f^Omega(i) = 0 for i != 0, w_c^Omega(i) = 1 - w_f^Omega(0), and w_f^Omega(0, l) the share of
/// level l among itself and all coarser ones in a Gaussian built from boxes,
///   4^l df/dl / integral over k > l of 4^k df/dk,  f(l) = exp(-4^l / c),  c = 2 pi sigma^2,
/// which is 16^l ln 4 / (c (4^l + c)), at most 1 (Xu, Ren and Wu 2019, "The power of box filters").
[[nodiscard]] PyramidWeights untrained_pyramid_weights(float radius);
[[nodiscard]] const PyramidTable& untrained_pyramid_table();

/// The weights in pyramid_table.cpp.
[[nodiscard]] const PyramidTable& trained_pyramid_table();

/// A source file that defines trained_pyramid_numbers() as `table`; `command` is what made it.
[[nodiscard]] std::string pyramid_table_source(const PyramidTable& table,
                                               const std::string& command);

/// Octave by octave, pass by pass: fine, coarse, gamma. Defined in pyramid_table.cpp.
[[nodiscard]] std::span<const float> trained_pyramid_numbers();

}  // namespace eigenlight
