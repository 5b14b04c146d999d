// The equations of the pyramid filter in double, on whole images.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "spatial/rivals/pyramid.h"
#include "tests/reference/pyramid_ranges.h"

namespace eigenlight::reference {

/// An image of N numbers a pixel.
template <std::size_t N>
struct Raster {
  explicit Raster(Extent size) : extent(size), pixels(size.pixels()) {}
  [[nodiscard]] std::array<double, N>& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y * extent.width + x)];
  }
  [[nodiscard]] const std::array<double, N>& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y * extent.width + x)];
  }
  Extent extent;
  std::vector<std::array<double, N>> pixels;
};

/// Light times weight and weight, and attributes.
template <std::size_t N>
struct Layer {
  Raster<4> light;
  Raster<N> attributes;
};

/// Pixels of a 2 x 2 block that exist.
using Block = std::vector<glm::ivec2>;

template <std::size_t N>
Block existing_pixels(const Range<N>& range, const Layer<N>& fine, int x, int y) {
  Block block;
  for (int i = 0; i < 4; ++i) {
    const glm::ivec2 p(2 * x + i % 2, 2 * y + i / 2);
    if (!fine.light.extent.contains(p.x, p.y)) continue;
    if (range.exists(fine.attributes.at(p.x, p.y))) block.push_back(p);
  }
  return block;
}

/// The pixel of a block that is most like its mean.
template <std::size_t N>
glm::ivec2 major_pixel(const Range<N>& range, const Layer<N>& fine, const Block& block,
                       double side) {
  std::array<double, N> mean{};
  for (const glm::ivec2 p : block) {
    for (std::size_t a = 0; a < N; ++a) mean[a] += fine.attributes.at(p.x, p.y)[a];
  }
  for (double& value : mean) value /= static_cast<double>(block.size());
  glm::ivec2 major = block[0];
  double best = -1.0;
  for (const glm::ivec2 p : block) {
    const double f = range.value(mean, fine.attributes.at(p.x, p.y), side * std::sqrt(0.5));
    if (best >= 0.0 && f <= best * std::exp(1e-4)) continue;
    best = f;
    major = p;
  }
  return major;
}

/// Eq. 3.
template <std::size_t N>
Layer<N> downsample(const Range<N>& range, const Layer<N>& fine, double side) {
  const Extent extent{(fine.light.extent.width + 1) / 2, (fine.light.extent.height + 1) / 2};
  Layer<N> coarse{Raster<4>(extent), Raster<N>(extent)};
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const Block block = existing_pixels(range, fine, x, y);
      if (block.empty()) continue;
      const glm::ivec2 major = major_pixel(range, fine, block, side);
      const auto& chosen = fine.attributes.at(major.x, major.y);
      double total = 0.0;
      for (const glm::ivec2 p : block) {
        const auto& own = fine.attributes.at(p.x, p.y);
        const double f = p == major ? 1.0 : range.value(chosen, own, side);
        total += f;
        for (std::size_t c = 0; c < 4; ++c) {
          coarse.light.at(x, y)[c] += f * fine.light.at(p.x, p.y)[c];
        }
        for (std::size_t a = 0; a < N; ++a) coarse.attributes.at(x, y)[a] += f * own[a];
      }
      for (double& value : coarse.light.at(x, y)) value /= total;
      for (double& value : coarse.attributes.at(x, y)) value /= total;
      if (range.keeps_major) coarse.attributes.at(x, y) = chosen;
    }
  }
  return coarse;
}

/// Weights of the 3 x 3 pixels around a pixel: f of this level, wb and fg of the coarser one.
struct UpsampleWeights {
  std::array<double, 9> f{}, wb{}, fg{};
};

template <std::size_t N>
UpsampleWeights upsample_weights(const Range<N>& range, const Layer<N>& fine,
                                 const Layer<N>& coarse, const std::array<int, 3>& side_x_y,
                                 const PyramidPass& pass) {
  const auto [side, x, y] = side_x_y;
  const auto& own = fine.attributes.at(x, y);
  UpsampleWeights weights;
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    const auto n = static_cast<std::size_t>(i);
    if (fine.light.extent.contains(x + dx, y + dy) &&
        range.exists(fine.attributes.at(x + dx, y + dy))) {
      const auto& other = fine.attributes.at(x + dx, y + dy);
      weights.f[n] = i == 4 ? 1.0 : range.value(own, other, side * std::hypot(dx, dy));
    }
    const int cx = x / 2 + dx, cy = y / 2 + dy;
    if (!coarse.light.extent.contains(cx, cy) || !range.exists(coarse.attributes.at(cx, cy))) {
      continue;
    }
    const double fc = range.value(own, coarse.attributes.at(cx, cy), side - 0.5);
    const double wd = (17.0 - 3.0 * std::abs(4 * dx - 2 * (x % 2) + 1)) / 24.0 *
                      (17.0 - 3.0 * std::abs(4 * dy - 2 * (y % 2) + 1)) / 24.0;
    weights.wb[n] = wd * fc * static_cast<double>(pass.coarse[n]);
    weights.fg[n] = std::pow(fc, range.gamma * static_cast<double>(pass.gamma));
  }
  return weights;
}

/// Eq. 2 at one pixel; `up` is the result one level up.
template <std::size_t N>
std::array<double, 4> upsample(const Range<N>& range, const Layer<N>& fine, const Layer<N>& coarse,
                               const Raster<4>& up, const std::array<int, 3>& side_x_y,
                               const PyramidPass& pass) {
  const auto [f, wb, fg] = upsample_weights(range, fine, coarse, side_x_y, pass);
  const int x = side_x_y[1], y = side_x_y[2];
  double all = 0.0, moved = 0.0;
  for (std::size_t n = 0; n < 9; ++n) {
    all += f[n];
    moved += wb[n] * (1.0 - fg[n]);
  }
  std::array<double, 4> sum{};
  double total = 0.0;
  for (std::size_t n = 0; n < 9; ++n) {
    const int dx = static_cast<int>(n) % 3 - 1, dy = static_cast<int>(n) / 3 - 1;
    const double wf = static_cast<double>(pass.fine[n]) * f[n] + moved * f[n] / all;
    const double wc = wb[n] * fg[n];
    for (std::size_t c = 0; c < 4; ++c) {
      if (wf > 0.0) sum[c] += wf * fine.light.at(x + dx, y + dy)[c];
      if (wc > 0.0) sum[c] += wc * up.at(x / 2 + dx, y / 2 + dy)[c];
    }
    total += wf + wc;
  }
  for (double& value : sum) value /= total;
  return sum;
}

template <std::size_t N>
Layer<N> base_layer(const Range<N>& range, const PyramidInputs& in) {
  const Extent extent = in.weight.extent();
  Layer<N> base{Raster<4>(extent), Raster<N>(extent)};
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      for (std::size_t a = 0; a < N; ++a) {
        base.attributes.at(x, y)[a] = static_cast<double>(in.attributes.at(x, y)[a]);
      }
      const auto w = static_cast<double>(in.weight(x, y));
      bool used = w > 0.0 && range.exists(base.attributes.at(x, y));
      for (const auto& plane : in.signal) used = used && std::isfinite(plane(x, y));
      if (!used) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        base.light.at(x, y)[c] = w * static_cast<double>(in.signal[c](x, y));
      }
      base.light.at(x, y)[3] = w;
    }
  }
  return base;
}

template <std::size_t N>
Planes<3> pyramid(const Range<N>& range, const PyramidInputs& in, const PyramidTable& table) {
  std::vector<Layer<N>> layers{base_layer(range, in)};
  double largest = 0.0;
  for (const auto& a : layers[0].attributes.pixels) {
    if (range.exists(a)) largest = std::max(largest, range.radius(a));
  }
  const int passes = pyramid_passes(static_cast<float>(largest));
  for (int l = 0; l < passes; ++l) {
    layers.push_back(downsample(range, layers.back(), std::exp2(l)));
  }
  Raster<4> up = layers.back().light;
  for (int l = passes - 1; l >= 0; --l) {
    const Layer<N>& fine = layers[static_cast<std::size_t>(l)];
    Raster<4> result(fine.light.extent);
    for (int y = 0; y < result.extent.height; ++y) {
      for (int x = 0; x < result.extent.width; ++x) {
        const auto& own = fine.attributes.at(x, y);
        if (!range.exists(own)) continue;
        result.at(x, y) =
            upsample(range, fine, layers[static_cast<std::size_t>(l) + 1], up, {1 << l, x, y},
                     table.at(static_cast<float>(range.radius(own)), l));
      }
    }
    up = result;
  }
  Planes<3> out = make_planes<3>(in.weight.extent());
  for (int y = 0; y < out[0].height(); ++y) {
    for (int x = 0; x < out[0].width(); ++x) {
      const auto& value = up.at(x, y);
      for (std::size_t c = 0; c < 3 && value[3] > 0.0; ++c) {
        out[c](x, y) = static_cast<float>(value[c] / value[3]);
      }
    }
  }
  return out;
}

/// The share of values that differ by more than `tolerance` (relative, and a hundredth of it
/// absolute) or are NaN. Where two pixels of a block are equally close to its mean but for
/// rounding, twin and filter may choose different major pixels, which changes the pixels around.
inline double share_beyond(double tolerance, const Planes<3>& a, const Planes<3>& b) {
  double beyond = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        const double wanted = static_cast<double>(b[c](x, y));
        const double off = std::abs(static_cast<double>(a[c](x, y)) - wanted);
        beyond += off <= tolerance * (std::abs(wanted) + 0.01) ? 0.0 : 1.0;
      }
    }
  }
  return beyond / (3.0 * static_cast<double>(a[0].extent().pixels()));
}

}  // namespace eigenlight::reference
