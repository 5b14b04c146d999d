// Twin of temporal/predict: one pixel, in double.
#pragma once

#include <array>

#include "temporal/predict.h"
#include "tests/reference/coefficients.h"
#include "tests/reference/tile_sums.h"

namespace eigenlight::reference {

struct Prediction {
  std::array<double, 3> light{};
  double residual = 0.0;
  double variance_factor = 0.0;
  bool confirmed = false;
};

inline Prediction predict(const BasisField& bases, const CoefficientField& coefficients,
                          const Planes<3>& light, int x, int y) {
  Prediction out;
  double r[3];
  for (int c = 0; c < 3; ++c) {
    double& sum = out.light[static_cast<std::size_t>(c)];
    for (int k = 0; k < bases.bases(); ++k) {
      sum += coefficient_at(coefficients, x, y, k) * bases.value(x, y, c, k);
    }
    r[c] = light[static_cast<std::size_t>(c)](x, y) - sum;
  }
  const double gain = coefficient_at(coefficients, x, y, 0);
  const double beyond = gain > 2.0 ? gain / 2.0 : std::min(2.0 * gain, 1.0);
  out.variance_factor = beyond * beyond;
  const double residual = luminance(r[0], r[1], r[2]);
  out.confirmed = bases.age(x, y) > 0.0f && std::isfinite(residual);
  out.residual = out.confirmed ? residual : 0.0;
  return out;
}

}  // namespace eigenlight::reference
