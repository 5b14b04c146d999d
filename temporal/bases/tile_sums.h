// Inner products over the pixels of a tile, from which coefficients are solved.
#pragma once

#include <array>
#include <vector>

#include "frame/frame.h"
#include "reproject/basis_field.h"
#include "reproject/taps.h"

namespace eigenlight {

/// Light beyond this magnitude counts as not finite: float holds its square, and the sum of a
/// window of 81 of them.
inline constexpr float kLargestLight = 1e18f;

/// Rows summed in float before the sums go to double. Call accumulate_tile() with multiples of it.
inline constexpr int kSumRows = 4;

/// Largest number of frames that light and the statistics of its coefficients are remembered.
inline constexpr float kLongestAge = 64.0f;

/// Deviations beyond which a pixel's innovation loses influence.
inline constexpr float kOutlier = 8.0f;

/// Index of (i, j), i <= j, in a packed upper triangle.
[[nodiscard]] constexpr int packed(int i, int j) { return j * (j + 1) / 2 + i; }

/// Sums over the pixels p of one tile, <a, b> = sum_p m(p) sum_c a_c(p) b_c(p), with r = u - V_0.
struct TileSums {
  std::array<double, kMaxBases*(kMaxBases + 1) / 2> gram{};  ///< <V_i, V_j>, packed
  std::array<double, kMaxBases> innovation{};                ///< <V_i, r>
  std::array<double, kMaxBases> scatter_rr{};                ///< sum_p m^2 (V_i . r)^2
  std::array<double, kMaxBases> scatter_r0{};                ///< sum_p m^2 (V_i . r) (V_i . V_0)
  std::array<double, kMaxBases> scatter_00{};                ///< sum_p m^2 (V_i . V_0)^2
  double pixels = 0.0;                                       ///< with m > 0
  double outliers = 0.0;                                     ///< of these, with reduced weight

  TileSums& operator+=(const TileSums& other);
  /// Variance of innovation[i] where the light's gain is 1 + delta, fitted to the same pixels:
  ///   sum_p m^2 (V_i . (r - delta V_0))^2 / (1 - 3 h),   h = sum_p (m V_0 . V_0)^2 / <V_0, V_0>^2.
  /// The tile has as much information as 1 / h equal pixels, hence 1 / h - 1 degrees of freedom;
  /// the denominator is the variance of Student's t. With three degrees or fewer it is
  /// scatter_rr[i].
  [[nodiscard]] double innovation_variance(std::size_t i, double delta) const;
};

struct SumInputs {
  const BasisField& bases;       ///< warped, not yet updated (leave one out)
  const Planes<3>& light;        ///< u: raw samples of one layer of light
  const Plane<float>& variance;  ///< of one frame's luminance, from earlier frames only
  int active = kMaxBases;        ///< bases that may hold energy; sums of the others stay 0
};

/// Adds the pixels of `tile` (at most kSegment wide, or a part of one) to `sums`. A pixel counts
/// with
///   m = n / (n + 1) / (variance + 0.01 * luminance(V_0)^2)
/// (the inverse of its expected squared innovation, n its age), and with 0 where it has no history
/// or u is not finite or beyond kLargestLight. Where m luminance(r)^2 > kOutlier^2, m is divided by
/// their ratio. Sums over kSumRows rows are in float, over those in double.
void accumulate_tile(const SumInputs& in, const Rect& tile, TileSums& sums);

/// Where more than an eighth of the pixels of a whole tile are outliers, the light has changed: the
/// tile is summed again with full weights. Fewer are taken for fireflies.
void admit_outliers(const SumInputs& in, const Rect& tile, TileSums& sums);

}  // namespace eigenlight
