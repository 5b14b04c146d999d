// Twin of temporal/bases/predict: one pixel, in double.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "temporal/bases/predict.h"
#include "tests/reference/coefficients.h"
#include "tests/reference/tile_sums.h"

namespace eigenlight::reference {

struct Prediction {
  std::array<double, 3> residual{};
  double innovation = 0.0;  // NaN: not confirmed
  double expected = 0.0;
  double variance_factor = 0.0;
};

/// `bases`, `coefficients` and `light` are those of the kernel, or the same in double.
template <typename Field, typename CoefficientsOf, typename LightOf>
Prediction predict(const Field& bases, const CoefficientsOf& coefficients, const LightOf& light,
                   int x, int y) {
  Prediction out;
  double sum[3] = {};
  for (int k = 0; k < bases.bases(); ++k) {
    const double coefficient = coefficient_at(coefficients, x, y, k);
    for (int c = 0; c < 3; ++c) sum[c] += coefficient * bases.value(x, y, c, k);
  }
  for (std::size_t c = 0; c < 3; ++c) out.residual[c] = light[c](x, y) - sum[c];
  out.expected = luminance(sum[0], sum[1], sum[2]);
  const double gain = coefficient_at(coefficients, x, y, 0);
  const double beyond = gain > 2.0 ? gain / 2.0 : std::min(2.0 * gain, 1.0);
  out.variance_factor = beyond * beyond;
  const double innovation = luminance(out.residual[0], out.residual[1], out.residual[2]);
  const bool confirmed = static_cast<double>(bases.age(x, y)) > 0.0 && std::isfinite(innovation);
  out.innovation = confirmed ? innovation : std::numeric_limits<double>::quiet_NaN();
  return out;
}

}  // namespace eigenlight::reference
