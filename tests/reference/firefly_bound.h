// Twin of temporal/samples/firefly_bound: blocks and pixels one by one, in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "temporal/samples/firefly_bound.h"
#include "tests/reference/image.h"
#include "tests/reference/tile_sums.h"

namespace eigenlight::reference {

/// FireflyInputs and FireflyOutputs in double, and the brightness of blocks.
struct FireflyImages {
  explicit FireflyImages(Extent extent)
      : expected(extent),
        age(extent),
        samples(extent),
        variance(extent),
        innovation(extent),
        residual(make_light(extent)),
        brightness({(extent.width + 7) / 8, (extent.height + 7) / 8}) {}

  /// v (1/s + 1/n)
  [[nodiscard]] double noise(int x, int y) const {
    return variance(x, y) * (1.0 / samples(x, y) + 1.0 / age(x, y));
  }
  [[nodiscard]] double sigma(int x, int y) const {
    const double light = 0.1 * expected(x, y);
    return std::sqrt(noise(x, y) + light * light);
  }
  [[nodiscard]] double luminance_of_residual(int x, int y) const {
    return luminance(residual[0](x, y), residual[1](x, y), residual[2](x, y));
  }

  Image expected, age, samples, variance, innovation;
  LightImages residual;
  Image brightness;
};

/// Visits the pixels of block (bx, by).
template <typename Body>
void each_in_block(Extent extent, int bx, int by, Body body) {
  for (int y = 8 * by; y < std::min(8 * by + 8, extent.height); ++y) {
    for (int x = 8 * bx; x < std::min(8 * bx + 8, extent.width); ++x) body(x, y);
  }
}

inline FireflyBlock firefly_block(const FireflyImages& in, double deviations, int bx, int by) {
  FireflyBlock block;
  each_in_block(in.age.extent(), bx, by, [&](int x, int y) {
    const bool usable = in.samples(x, y) > 0.0;
    if (!std::isnan(in.innovation(x, y))) {
      ++block.confirmed;
      block.outliers += std::abs(in.innovation(x, y)) > deviations * in.sigma(x, y) ? 1 : 0;
    } else if (usable) {
      ++block.fresh;
    }
    if (!usable) return;
    ++block.usable;
    block.root += std::sqrt(std::abs(in.expected(x, y) + in.luminance_of_residual(x, y)));
  });
  return block;
}

/// Scales back the light of a pixel; false where it may stay.
inline bool bound_pixel(const FireflyOptions& options, bool is_steady, double brightness, int x,
                        int y, FireflyImages& images) {
  double factor = 1.0;
  if (!std::isnan(images.innovation(x, y))) {
    const double size = std::abs(images.innovation(x, y)), sigma = images.sigma(x, y);
    if (!is_steady || size <= options.deviations * sigma) return false;
    const double n = images.age(x, y), s = images.samples(x, y);
    factor = std::min((n + s) / (s * std::sqrt(n)), static_cast<double>(options.deviations)) *
             sigma / size;
    images.innovation(x, y) = std::numeric_limits<double>::quiet_NaN();
  } else {
    const double size = std::abs(images.luminance_of_residual(x, y));
    const bool is_new = images.samples(x, y) > 0.0 && images.age(x, y) == 0.0;
    if (!is_new || size <= brightness) return false;
    factor = brightness / size;
  }
  for (Image& plane : images.residual) plane(x, y) *= factor;
  return true;
}

/// FireflyBound: count() of the whole image, then bound().
inline int bound_fireflies(const FireflyOptions& options, FireflyImages& images) {
  const Image& grid = images.brightness;
  std::vector<FireflyBlock> blocks;
  grid.each([&](int bx, int by) {
    blocks.push_back(firefly_block(images, static_cast<double>(options.deviations), bx, by));
  });
  const auto block_at = [&](int bx, int by) -> const FireflyBlock& {
    return blocks[static_cast<std::size_t>(by * grid.extent().width + bx)];
  };
  int bounded = 0;
  images.brightness.each([&](int bx, int by) {
    FireflyBlock sum;
    grid.each_around({bx, by}, 1, [&](int i, int j) {
      const FireflyBlock& block = block_at(i, j);
      sum.confirmed += block.confirmed;
      sum.outliers += block.outliers;
      sum.usable += block.usable;
      sum.fresh += block.fresh;
      sum.root += block.root;
    });
    const double mean = sum.usable > 0 ? sum.root / sum.usable : 0.0;
    const double brightness = static_cast<double>(options.times) * mean * mean;
    const auto few = [](const FireflyBlock& block, double share) {
      return block.outliers <= share * block.confirmed;
    };
    const double share = static_cast<double>(options.share);
    const bool is_steady = few(sum, share) && few(block_at(bx, by), 2.0 * share);
    images.brightness(bx, by) =
        sum.fresh > 0 ? brightness : std::numeric_limits<double>::infinity();
    each_in_block(images.age.extent(), bx, by, [&](int x, int y) {
      bounded += bound_pixel(options, is_steady, brightness, x, y, images) ? 1 : 0;
    });
  });
  return bounded;
}

}  // namespace eigenlight::reference
