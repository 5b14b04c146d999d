// Twin of temporal/samples/signal: one pixel, in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "temporal/bases/tile_sums.h"
#include "temporal/samples/signal.h"
#include "tests/reference/tile_sums.h"

namespace eigenlight::reference {

struct MergedSamples {
  std::array<double, 3> light{};  // NaN where it is not usable
  double samples = 0.0;
};

inline MergedSamples merged_samples(const SignalInputs& in, int x, int y) {
  const double regular = std::max(in.frame.spp, 1);
  const double extra = in.extra != nullptr ? (*in.extra)(x, y) : 0.0;
  MergedSamples out;
  double size = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = regular * static_cast<double>(in.raw[c](x, y));
    if (extra > 0.0) sum += extra * static_cast<double>((*in.extra_mean)[c](x, y));
    out.light[c] = sum / (regular + extra);
    size += std::abs(out.light[c]);
  }
  if (in.frame.surface.id(x, y) != 0 && size <= static_cast<double>(kLargestLight)) {
    out.samples = (regular + extra) / regular;
  } else {
    out.light.fill(std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

/// Variance of luminance around a new pixel. `samples` and `brightness` are those of FreshInputs,
/// or the same in double.
template <typename Samples, typename Brightness>
double fresh_variance(const Planes<3>& light, const Samples& samples, const Brightness& brightness,
                      glm::ivec2 p) {
  const Extent extent = light[0].extent();
  double count = 0.0, sum = 0.0, square = 0.0;
  for (int y = std::max(p.y - 3, 0); y <= std::min(p.y + 3, extent.height - 1); ++y) {
    for (int x = std::max(p.x - 3, 0); x <= std::min(p.x + 3, extent.width - 1); ++x) {
      if (!(samples(x, y) > 0)) continue;
      const double most = brightness(x / 8, y / 8);
      const double l =
          std::clamp(luminance(light[0](x, y), light[1](x, y), light[2](x, y)), -most, most);
      count += 1.0;
      sum += l;
      square += l * l;
    }
  }
  return count > 1.0 ? std::max(square / count - sum * sum / (count * count), 0.0) : 0.0;
}

}  // namespace eigenlight::reference
