// Twin of temporal/bases/update: one pixel, in double, line by line as in the header.
#pragma once

#include <algorithm>
#include <array>

#include "temporal/bases/update.h"
#include "tests/reference/coefficients.h"

namespace eigenlight::reference {

struct Updated {
  std::array<std::array<double, kMaxBases>, 3> basis{};  // [channel][k]
  std::array<double, 3> estimate{};
  double age = 0.0;
};

/// c and q of a pixel, and h = c . q. h is at least 1 for every c and q of one tile, but may be
/// less between tiles.
struct PixelCoefficients {
  std::array<double, kMaxBases> c{}, q{};
  double h = 0.0;
};

template <typename In>
PixelCoefficients pixel_coefficients(const In& in, int x, int y) {
  PixelCoefficients out;
  for (int k = 0; k < in.active; ++k) {
    const auto at = static_cast<std::size_t>(k);
    out.c[at] = k == 0 ? 1.0 : coefficient_at(in.coefficients, x, y, k);
    out.q[at] = coefficient_at(in.learning_rates, x, y, k);
    out.h += out.c[at] * out.q[at];
  }
  out.h = std::max(out.h, 1.0);
  return out;
}

/// `In` is UpdateInputs and `Field` BasisField, or the same in double.
template <typename In, typename Field>
Updated update(const In& in, const Field& old, glm::ivec2 p) {
  Updated out;
  const int x = p.x, y = p.y;
  const bool known = in.old_age(x, y) > 0, usable = in.samples(x, y) > 0;
  const double s = in.samples(x, y);
  const double n = known ? std::max(0.0, static_cast<double>(in.new_age(x, y)) - s) : 0.0;
  out.age = known || usable ? static_cast<double>(in.new_age(x, y)) : 0.0;
  const auto [c, q, h] = pixel_coefficients(in, x, y);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const double correction = known && in.correction != nullptr
                                  ? static_cast<double>((*in.correction)[channel](x, y))
                                  : 0.0;
    const double r = usable ? in.residual[channel](x, y) - correction : 0.0;
    const double learned =
        (in.newborn == 0 ? correction / h : 0.0) + (usable ? r * s / (n + h * s) : 0.0);
    for (int k = 0; k < in.active; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const double before = known ? old.value(x, y, static_cast<int>(channel), k) : 0.0;
      const double scaled = k == 0 ? coefficient_at(in.coefficients, x, y, 0) * before : before;
      out.basis[channel][at] = scaled + q[at] * learned;
      out.estimate[channel] += c[at] * out.basis[channel][at];
    }
    if (in.newborn > 0) {
      out.basis[channel][static_cast<std::size_t>(in.newborn)] = correction;
      out.estimate[channel] += correction;
    }
  }
  return out;
}

}  // namespace eigenlight::reference
