// Fireflies and the smoothed innovation, in double.
#pragma once

#include <limits>

#include "temporal/change/correction.h"
#include "temporal/samples/firefly_bound.h"
#include "tests/reference/atrous.h"
#include "tests/reference/pipeline/coefficients.h"

namespace eigenlight::twin {

/// What the stages between prediction and update share.
struct Residual {
  explicit Residual(Extent extent)
      : prediction(make_light(extent)),
        light(make_light(extent)),
        correction(make_light(extent)),
        samples(extent),
        confirmed(extent),
        value(extent),
        age(extent),
        variance(extent),
        brightness({(extent.width + 7) / 8, (extent.height + 7) / 8}),
        change(extent) {}
  /// v (1/s + 1/n)
  [[nodiscard]] double noise(int x, int y) const {
    return variance(x, y) * (1.0 / samples(x, y) + 1.0 / age(x, y));
  }
  Light prediction, light, correction;
  Image samples, confirmed, value, age, variance;
  Image brightness;   // of blocks
  TileValues change;  // how surely the light of each tile changed
};

/// Visits the pixels of a block.
template <typename Body>
void each_in_block(Extent extent, int bx, int by, Body body) {
  for (int y = 8 * by; y < std::min(8 * by + 8, extent.height); ++y) {
    for (int x = 8 * bx; x < std::min(8 * bx + 8, extent.width); ++x) body(x, y);
  }
}

inline double firefly_sigma(const Residual& r, int x, int y) {
  const double expected = 0.1 * luminance(r.prediction, x, y);
  return std::sqrt(r.noise(x, y) + expected * expected);
}

/// Counts of blocks, before any of them changes.
inline std::vector<FireflyBlock> firefly_blocks(const Residual& r, const FireflyOptions& options) {
  std::vector<FireflyBlock> blocks;
  r.brightness.each([&](int bx, int by) {
    FireflyBlock block;
    each_in_block(r.value.extent, bx, by, [&](int x, int y) {
      const bool confirmed = r.confirmed(x, y) > 0.0, usable = r.samples(x, y) > 0.0;
      block.confirmed += confirmed ? 1 : 0;
      block.outliers +=
          confirmed && std::abs(r.value(x, y)) > options.deviations * firefly_sigma(r, x, y) ? 1
                                                                                             : 0;
      block.usable += usable ? 1 : 0;
      block.fresh += usable && !confirmed ? 1 : 0;
      block.root += usable ? std::sqrt(std::abs(luminance(r.light, x, y))) : 0.0;
    });
    blocks.push_back(block);
  });
  return blocks;
}

inline void bound_pixel(const FireflyOptions& options, bool steady, double brightness, int x, int y,
                        Residual& r) {
  if (r.confirmed(x, y) > 0.0) {
    const double size = std::abs(r.value(x, y)), sigma = firefly_sigma(r, x, y);
    if (!steady || size <= options.deviations * sigma) return;
    const double n = r.age(x, y), s = r.samples(x, y);
    const double step =
        std::min((n + s) / (s * std::sqrt(n)), static_cast<double>(options.deviations));
    for (std::size_t c = 0; c < 3; ++c) {
      const double from = r.prediction[c](x, y);
      r.light[c](x, y) = from + step * sigma / size * (r.light[c](x, y) - from);
    }
    r.value(x, y) = r.confirmed(x, y) = 0.0;
  } else if (r.samples(x, y) > 0.0) {
    const double size = std::abs(luminance(r.light, x, y));
    if (size <= brightness) return;
    for (auto& plane : r.light) plane(x, y) *= brightness / size;
  }
}

inline void bound(const FireflyOptions& options, Residual& r) {
  const std::vector<FireflyBlock> blocks = firefly_blocks(r, options);
  r.brightness.each([&](int bx, int by) {
    FireflyBlock sum;
    r.brightness.each_around({bx, by}, 1, [&](int i, int j) {
      const FireflyBlock& block = blocks[r.brightness.index(i, j)];
      sum.confirmed += block.confirmed;
      sum.outliers += block.outliers;
      sum.usable += block.usable;
      sum.fresh += block.fresh;
      sum.root += block.root;
    });
    const double mean = sum.usable > 0 ? sum.root / sum.usable : 0.0;
    const double brightness = options.times * mean * mean;
    const auto few = [](const FireflyBlock& block, double share) {
      return block.outliers <= share * block.confirmed;
    };
    const double share = static_cast<double>(options.share);
    const bool steady = few(sum, share) && few(blocks[r.brightness.index(bx, by)], 2.0 * share);
    r.brightness(bx, by) = sum.fresh > 0 ? brightness : std::numeric_limits<double>::infinity();
    each_in_block(r.value.extent, bx, by,
                  [&](int x, int y) { bound_pixel(options, steady, brightness, x, y, r); });
  });
}

/// g - the gate of each tile, from the share of significant blocks around.
inline TileValues open_gates(const Residual& r) {
  TileValues gate(r.value.extent), all(r.value.extent), significant(r.value.extent);
  r.brightness.each([&](int bx, int by) {
    double sum = 0.0, noise = 0.0, count = 0.0;
    each_in_block(r.value.extent, bx, by, [&](int x, int y) {
      if (!(r.confirmed(x, y) > 0.0)) return;
      sum += r.value(x, y);
      noise += r.noise(x, y);
      count += 1.0;
    });
    if (count < 16.0) return;
    const int tile = by / 4 * gate.grid.columns() + bx / 4;
    all[tile] += 1.0;
    significant[tile] += sum * sum > 9.0 * noise ? 1.0 : 0.0;
  });
  const int columns = gate.grid.columns();
  const Image tiles({columns, gate.grid.rows()});
  tiles.each([&](int tx, int ty) {
    double a = 0.0, s = -1.0;
    tiles.each_around({tx, ty}, 1, [&](int i, int j) {
      a += all[j * columns + i];
      s += significant[j * columns + i];
    });
    gate[ty * columns + tx] = a > 0.0 ? std::clamp((s / a - 0.03) / 0.04, 0.0, 1.0) : 0.0;
  });
  return gate;
}

}  // namespace eigenlight::twin
