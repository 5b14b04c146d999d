// Twin of temporal/change/innovation: one pixel, its window summed directly, in double.
#pragma once

#include <algorithm>
#include <cmath>

#include "temporal/change/innovation.h"

namespace eigenlight::reference {

struct Innovation {
  double age = 0.0;
  double variance = 0.0;
};

/// `variance` is that of the history; `In` is InnovationInputs, or the same in double.
template <typename In>
Innovation innovation(const In& in, const InnovationOptions& options, glm::ivec2 p,
                      double variance) {
  double count = 0.0, sum = 0.0;
  const auto over_window = [&](const auto& visit) {
    for (int y = p.y - 4; y <= p.y + 4; ++y) {
      for (int x = p.x - 4; x <= p.x + 4; ++x) {
        if (in.innovation.extent().contains(x, y) && !std::isnan(in.innovation(x, y))) {
          visit(static_cast<double>(in.innovation(x, y)));
        }
      }
    }
  };
  over_window([&](double e) {
    count += 1.0;
    sum += e;
  });
  const double n = in.age(p.x, p.y), s = in.samples(p.x, p.y);
  const double oldest = std::max(static_cast<double>(options.max_age), s);
  if (std::isnan(in.innovation(p.x, p.y)) || count == 1.0)
    return {std::min(n + s, oldest), variance};
  const double mu = sum / count;
  double v = 0.0;
  over_window([&](double e) { v += (e - mu) * (e - mu) / count; });

  const double standard_error = v / count * (1.0 + 1.0 / n);
  const double bias = std::max(0.0, mu * mu - options.threshold * standard_error);
  const double history = v / n + bias, fresh = v / s;
  const double w = history + fresh > 0.0 ? history / (history + fresh) : s / (n + s);
  const double age = std::min(s / w, oldest);
  return {age, variance + (v - variance) / std::min(age / s, 16.0)};
}

}  // namespace eigenlight::reference
