// Twin of temporal/update: one pixel, in double, line by line as in the header.
#pragma once

#include <array>

#include "temporal/update.h"
#include "tests/reference/coefficients.h"

namespace eigenlight::reference {

struct Updated {
  std::array<std::array<double, kMaxBases>, 3> basis{};  // [channel][k]
  std::array<double, 3> estimate{};
  double age = 0.0;
};

inline Updated update(const UpdateInputs& in, const BasisField& old, glm::ivec2 p, int newborn) {
  Updated out;
  const int x = p.x, y = p.y;
  const bool known = in.old_age(x, y) > 0.0f, usable = in.samples(x, y) > 0.0f;
  out.age = known || usable ? static_cast<double>(in.new_age(x, y)) : 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double u = in.light[c](x, y);
    auto& v = out.basis[c];
    if (!known) {
      v[0] = usable ? u : 0.0;
      out.estimate[c] = v[0];
      continue;
    }
    const double r = usable ? u - in.prediction[c](x, y) : 0.0;
    const double w = usable ? in.samples(x, y) / out.age : 0.0;
    for (int k = 0; k < old.bases(); ++k) {
      const double coefficient = coefficient_at(in.coefficients, x, y, k);
      const double before = old.value(x, y, static_cast<int>(c), k);
      double& next = v[static_cast<std::size_t>(k)];
      next = k == 0 ? coefficient * before + w * r
                    : (1.0 - w) * before + w * coefficient * (coefficient * before + r);
      // A newborn basis still counts with its old value in this frame's estimate.
      out.estimate[c] += k == 0 ? next : coefficient * (k == newborn ? before : next);
      if (k > 0 && k == newborn) next = r;
    }
  }
  return out;
}

}  // namespace eigenlight::reference
