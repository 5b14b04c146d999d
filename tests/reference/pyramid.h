// The pyramid filter as its equations have it: double, whole images, range functions and their
// powers written out.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "frame/frame.h"
#include "spatial/rivals/pyramid.h"

namespace eigenlight::reference {

/// An image of N numbers a pixel.
template <std::size_t N>
struct Image {
  explicit Image(Extent size) : extent(size), pixels(size.pixels()) {}
  [[nodiscard]] std::array<double, N>& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y * extent.width + x)];
  }
  [[nodiscard]] const std::array<double, N>& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y * extent.width + x)];
  }
  Extent extent;
  std::vector<std::array<double, N>> pixels;
};

/// f^R, at a distance in pixels of the image; which pixels exist; how attributes go up.
template <std::size_t N>
struct Range {
  std::function<double(const std::array<double, N>&, const std::array<double, N>&, double)> value;
  std::function<bool(const std::array<double, N>&)> exists;
  std::function<double(const std::array<double, N>&)> radius;
  bool keeps_major = true;
  double gamma = 1.0;  // times that of a pass
};

/// Light times weight and weight, and attributes.
template <std::size_t N>
struct Layer {
  Image<4> light;
  Image<N> attributes;
};

/// Eq. 3.
template <std::size_t N>
Layer<N> downsample(const Range<N>& range, const Layer<N>& fine, double side) {
  const Extent extent{(fine.light.extent.width + 1) / 2, (fine.light.extent.height + 1) / 2};
  Layer<N> coarse{Image<4>(extent), Image<N>(extent)};
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      std::vector<std::array<int, 2>> block;
      std::array<double, N> mean{};
      for (int i = 0; i < 4; ++i) {
        const int fx = 2 * x + i % 2, fy = 2 * y + i / 2;
        if (!fine.light.extent.contains(fx, fy)) continue;
        if (!range.exists(fine.attributes.at(fx, fy))) continue;
        block.push_back({fx, fy});
        for (std::size_t a = 0; a < N; ++a) mean[a] += fine.attributes.at(fx, fy)[a];
      }
      if (block.empty()) continue;
      for (double& value : mean) value /= static_cast<double>(block.size());
      std::size_t major = 0;
      double best = -1.0;
      for (std::size_t m = 0; m < block.size(); ++m) {
        const double f =
            range.value(mean, fine.attributes.at(block[m][0], block[m][1]), side * std::sqrt(0.5));
        if (m > 0 && f <= best * std::exp(1e-4)) continue;
        best = f;
        major = m;
      }
      const auto& chosen = fine.attributes.at(block[major][0], block[major][1]);
      double total = 0.0;
      for (std::size_t m = 0; m < block.size(); ++m) {
        const auto& own = fine.attributes.at(block[m][0], block[m][1]);
        const double f = m == major ? 1.0 : range.value(chosen, own, side);
        total += f;
        for (std::size_t c = 0; c < 4; ++c) {
          coarse.light.at(x, y)[c] += f * fine.light.at(block[m][0], block[m][1])[c];
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

/// Eq. 2 at one pixel; `up` is the result one level up.
template <std::size_t N>
std::array<double, 4> upsample(const Range<N>& range, const Layer<N>& fine, const Layer<N>& coarse,
                               const Image<4>& up, const std::array<int, 3>& side_x_y,
                               const PyramidPass& pass) {
  const auto [side, x, y] = side_x_y;
  const auto& own = fine.attributes.at(x, y);
  std::array<double, 9> f{}, wb{}, fg{};
  double all = 0.0, moved = 0.0;
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    const auto n = static_cast<std::size_t>(i);
    if (fine.light.extent.contains(x + dx, y + dy) &&
        range.exists(fine.attributes.at(x + dx, y + dy))) {
      f[n] = i == 4
                 ? 1.0
                 : range.value(own, fine.attributes.at(x + dx, y + dy), side * std::hypot(dx, dy));
    }
    all += f[n];
    const int cx = x / 2 + dx, cy = y / 2 + dy;
    if (!coarse.light.extent.contains(cx, cy) || !range.exists(coarse.attributes.at(cx, cy))) {
      continue;
    }
    const double fc = range.value(own, coarse.attributes.at(cx, cy), side - 0.5);
    const double wd = (17.0 - 3.0 * std::abs(4 * dx - 2 * (x % 2) + 1)) / 24.0 *
                      (17.0 - 3.0 * std::abs(4 * dy - 2 * (y % 2) + 1)) / 24.0;
    wb[n] = wd * fc * static_cast<double>(pass.coarse[n]);
    fg[n] = std::pow(fc, range.gamma * static_cast<double>(pass.gamma));
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
  Layer<N> base{Image<4>(extent), Image<N>(extent)};
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
  Image<4> up = layers.back().light;
  for (int l = passes - 1; l >= 0; --l) {
    const Layer<N>& fine = layers[static_cast<std::size_t>(l)];
    Image<4> result(fine.light.extent);
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
/// absolute) or are no numbers. Where two pixels of a block are as close to its mean to within
/// rounding, twin and filter may take different ones for the major pixel; all around follows.
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

/// Eq. 9 for diffuse light, z in units of z_p.
inline Range<4> global_illumination_range(const GlobalIlluminationEdge& edge) {
  using A = std::array<double, 4>;
  return {[edge](const A& p, const A& q, double) {
            const double cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
            return std::pow(std::clamp(cosine, 0.0, 1.0), static_cast<double>(edge.normal_power)) *
                   std::exp(-static_cast<double>(edge.depth_scale) * std::abs(p[3] - q[3]) / p[3]);
          },
          [](const A& a) { return a[3] > 0.0; },
          [edge](const A&) { return static_cast<double>(edge.blur_radius); }, true,
          static_cast<double>(edge.gamma_scale)};
}

/// Eq. 9 for reflections.
inline Range<5> reflection_range(const ReflectionEdge& edge) {
  using A = std::array<double, 5>;
  const Range<4> geometry = global_illumination_range(edge.geometry);
  const auto head = [](const A& a) { return std::array<double, 4>{a[0], a[1], a[2], a[3]}; };
  return {[=](const A& p, const A& q, double d) {
            const double t = std::min(std::abs(p[4] - q[4]) / 0.5, 1.0);
            return geometry.value(head(p), head(q), d) * (1.0 - t * t * (3.0 - 2.0 * t));
          },
          [](const A& a) { return a[3] > 0.0; },
          [edge](const A& a) { return static_cast<double>(edge.geometry.blur_radius) * a[4]; },
          true, static_cast<double>(edge.geometry.gamma_scale)};
}

/// Attributes of GlobalIlluminationEdge: 0 where no surface counts.
inline Plane<float> surface_attributes(const GBuffer& surface) {
  Plane<float> attributes(surface.depth.extent(), 4);
  for (int y = 0; y < attributes.height(); ++y) {
    for (int x = 0; x < attributes.width(); ++x) {
      const float own[4] = {surface.normal[0](x, y), surface.normal[1](x, y),
                            surface.normal[2](x, y), surface.depth(x, y)};
      const bool finite = std::all_of(own, own + 4, [](float v) { return std::isfinite(v); });
      if (surface.id(x, y) != 0 && finite && own[3] > 0.0f) {
        std::copy_n(own, 4, attributes.at(x, y));
      }
    }
  }
  return attributes;
}

/// Eq. 8.
inline Range<1> depth_of_field_range(const DepthOfFieldEdge& edge) {
  using A = std::array<double, 1>;
  const double sigma = static_cast<double>(edge.sigma);
  return {[](const A& p, const A& q, double d) {
            const double circle = std::max(std::min(p[0], q[0]), 1e-3);
            return std::exp(-18.0 * d * d / (circle * circle));
          },
          [](const A&) { return true; },
          [sigma](const A& a) {
            const double circle = std::max(a[0], 1e-3);
            const double variance = 1.0 / (36.0 / (circle * circle) + 1.0 / (sigma * sigma));
            return std::max(3.0 * std::sqrt(variance) - 1.0, 0.0);
          },
          false};
}

/// Eq. 10.
inline Range<1> particle_range(const ParticleEdge& edge) {
  using A = std::array<double, 1>;
  return {[edge](const A& p, const A& q, double) {
            return std::exp(-static_cast<double>(edge.depth_scale) * p[0] * std::abs(p[0] - q[0]));
          },
          [](const A& a) { return a[0] > 0.0 && std::isfinite(a[0]); },
          [edge](const A&) { return static_cast<double>(edge.blur_radius); }, true,
          static_cast<double>(edge.gamma_scale)};
}

}  // namespace eigenlight::reference
