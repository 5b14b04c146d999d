#include "temporal/samples/firefly_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "frame/luminance.h"

namespace eigenlight {
namespace {

void scale(float factor, int x, int y, Planes<3>& planes) {
  for (auto& plane : planes) plane(x, y) *= factor;
}

}  // namespace

void FireflyOptions::validate() const {
  EL_CHECK(deviations >= 1.0f && deviations <= 1000.0f, "firefly deviations {}: expected [1, 1000]",
           deviations);
  EL_CHECK(times >= 1.0f && times <= 1000.0f, "firefly times {}: expected [1, 1000]", times);
  EL_CHECK(share > 0.0f && share <= 1.0f, "firefly share {}: expected (0, 1]", share);
}

FireflyBound::FireflyBound(Extent extent, const FireflyOptions& options)
    : options_(options),
      grid_(extent, kFireflyBlock, kFireflyBlock),
      brightness_({grid_.columns(), grid_.rows()}),
      blocks_(static_cast<std::size_t>(grid_.count())),
      bounded_(static_cast<std::size_t>(grid_.rows())) {
  options.validate();
}

// Of the innovation of a confirmed pixel.
float FireflyBound::deviation(const FireflyInputs& in, int x, int y) const {
  const float noise = in.variance(x, y) * (1.0f / in.samples(x, y) + 1.0f / in.age(x, y));
  const float expected = 0.1f * in.expected(x, y);
  return std::sqrt(noise + expected * expected);
}

// Deviations by which an outlier may be off. It has the weight s / (n + s) in the new mean, and the
// mean the deviation 1 / sqrt(n) of a frame's.
float FireflyBound::step(const FireflyInputs& in, int x, int y) const {
  const float n = in.age(x, y), s = in.samples(x, y);
  return std::min((n + s) / (s * std::sqrt(n)), options_.deviations);
}

FireflyBound::Region FireflyBound::region(const Tile& tile) const {
  const int column = tile.index % grid_.columns(), row = tile.index / grid_.columns();
  FireflyBlock sum;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid_.rows() - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid_.columns() - 1); ++x) {
      const FireflyBlock& block = blocks_[static_cast<std::size_t>(y * grid_.columns() + x)];
      sum.confirmed += block.confirmed;
      sum.outliers += block.outliers;
      sum.usable += block.usable;
      sum.fresh += block.fresh;
      sum.root += block.root;
    }
  }
  const double mean = sum.usable > 0 ? sum.root / sum.usable : 0.0;
  const auto few = [&](const FireflyBlock& block, float share) {
    return static_cast<float>(block.outliers) <= share * static_cast<float>(block.confirmed);
  };
  const FireflyBlock& own = blocks_[static_cast<std::size_t>(tile.index)];
  return {few(sum, options_.share) && few(own, 2.0f * options_.share), sum.fresh > 0,
          options_.times * static_cast<float>(mean * mean)};
}

int FireflyBound::bound_block(const FireflyInputs& in, const Tile& tile,
                              const FireflyOutputs& out) {
  const FireflyBlock& own = blocks_[static_cast<std::size_t>(tile.index)];
  const Region around = region(tile);
  brightness_(tile.index % grid_.columns(), tile.index / grid_.columns()) =
      around.is_fresh ? around.brightness : std::numeric_limits<float>::infinity();
  if (own.outliers == 0 && own.fresh == 0) return 0;
  int bounded = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      float& innovation = out.innovation(x, y);
      if (!std::isnan(innovation)) {
        const float size = std::abs(innovation);
        if (!around.is_steady || size == 0.0f) continue;
        const float sigma = deviation(in, x, y);
        if (size <= options_.deviations * sigma) continue;
        scale(step(in, x, y) * sigma / size, x, y, out.residual);
        innovation = std::numeric_limits<float>::quiet_NaN();
        ++bounded;
      } else if (in.samples(x, y) > 0.0f && in.age(x, y) == 0.0f) {
        const float size = std::abs(luminance(out.residual, x, y));
        if (size <= around.brightness) continue;
        scale(around.brightness / size, x, y, out.residual);
        ++bounded;
      }
    }
  }
  return bounded;
}

void FireflyBound::count(const FireflyInputs& in, const FireflyOutputs& out, const Rect& area) {
  EL_DCHECK(area.x0 % kFireflyBlock == 0 && area.y0 % kFireflyBlock == 0);
  for (int y = area.y0; y < area.y1; y += kFireflyBlock) {
    for (int x = area.x0; x < area.x1; x += kFireflyBlock) {
      const int index = y / kFireflyBlock * grid_.columns() + x / kFireflyBlock;
      blocks_[static_cast<std::size_t>(index)] =
          count_fireflies(in, options_.deviations, out, grid_.tile(index));
    }
  }
}

std::int64_t FireflyBound::bound(const FireflyInputs& in, const FireflyOutputs& out,
                                 const std::function<void(const Tile&)>& changed) {
  const int columns = grid_.columns();
  parallel_for(grid_.rows(), [&](int row) {
    int bounded = 0;
    for (int i = row * columns; i < (row + 1) * columns; ++i) {
      const int here = bound_block(in, grid_.tile(i), out);
      if (here > 0) changed(grid_.tile(i));
      bounded += here;
    }
    bounded_[static_cast<std::size_t>(row)] = bounded;
  });
  return std::accumulate(bounded_.begin(), bounded_.end(), std::int64_t{0});
}

}  // namespace eigenlight
