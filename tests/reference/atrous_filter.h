// Twin of spatial/rivals/atrous_filter: double, pass by pass over whole images.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "spatial/rivals/atrous_filter.h"
#include "tests/reference/surface_points.h"
#include "tests/support/spatial_case.h"

namespace eigenlight::reference {

struct AtrousPixel {
  glm::dvec3 color{0.0};
  double weight = 0.0;
};

class AtrousTwin {
 public:
  AtrousTwin(const SpatialCase& c, const AtrousFilterOptions& options)
      : case_(c), options_(options), pixels_(c.extent().pixels()) {
    double luminance = 0.0, count = 0.0;
    for_pixels([&](glm::ivec2 p) {
      if (!c.is_usable(p.x, p.y)) return;
      at(pixels_, p) = {vector_at(c.signal, p), static_cast<double>(c.weight(p.x, p.y))};
      luminance += glm::dot(glm::dvec3(0.2126, 0.7152, 0.0722), at(pixels_, p).color);
      count += 1.0;
    });
    mean_ = count > 0.0 ? luminance / count : 0.0;
  }

  [[nodiscard]] Planes<3> run() {
    for (int i = 0; i < options_.passes; ++i) pass(i);
    Planes<3> out = make_planes<3>(case_.extent());
    for_pixels([&](glm::ivec2 p) {
      for (int c = 0; c < 3; ++c) {
        out[static_cast<std::size_t>(c)](p.x, p.y) = static_cast<float>(at(pixels_, p).color[c]);
      }
    });
    return out;
  }

 private:
  template <typename Visit>
  void for_pixels(const Visit& visit) const {
    for (int y = 0; y < case_.extent().height; ++y) {
      for (int x = 0; x < case_.extent().width; ++x) visit(glm::ivec2(x, y));
    }
  }
  [[nodiscard]] AtrousPixel& at(std::vector<AtrousPixel>& pixels, glm::ivec2 p) const {
    return pixels[static_cast<std::size_t>(p.y * case_.extent().width + p.x)];
  }

  [[nodiscard]] double weight(int i, glm::ivec2 p, glm::ivec2 q) {
    const SurfacePoint a = surface_point(case_.frame, p), b = surface_point(case_.frame, q);
    const double color = std::ldexp(static_cast<double>(options_.sigma_color) * mean_, -i);
    const double normal = std::ldexp(static_cast<double>(options_.sigma_normal), i);
    const double position = static_cast<double>(options_.sigma_position) * a.depth;
    double exponent = squared(a.normal - b.normal) / (normal * normal) +
                      squared(a.position - b.position) / (position * position);
    if (at(pixels_, p).weight > 0.0) {
      exponent += squared(at(pixels_, p).color - at(pixels_, q).color) / (color * color);
    }
    return std::exp(-exponent);
  }

  void pass(int i) {
    constexpr std::array<double, 5> kSpline{1 / 16.0, 1 / 4.0, 3 / 8.0, 1 / 4.0, 1 / 16.0};
    std::vector<AtrousPixel> next(pixels_.size());
    for_pixels([&](glm::ivec2 p) {
      if (case_.frame.surface.id(p.x, p.y) == 0) return;
      AtrousPixel sum;
      for (int k = 0; k < 25; ++k) {
        const glm::ivec2 q = p + (glm::ivec2(k % 5, k / 5) - 2) * (1 << i);
        if (!case_.extent().contains(q.x, q.y) || at(pixels_, q).weight == 0.0) continue;
        const double w = kSpline[static_cast<std::size_t>(k % 5)] *
                         kSpline[static_cast<std::size_t>(k / 5)] * at(pixels_, q).weight *
                         weight(i, p, q);
        sum.color += w * at(pixels_, q).color;
        sum.weight += w;
      }
      if (sum.weight > 0.0) at(next, p) = {sum.color / sum.weight, 1.0};
    });
    pixels_ = std::move(next);
  }

  const SpatialCase& case_;
  AtrousFilterOptions options_;
  std::vector<AtrousPixel> pixels_;
  double mean_ = 0.0;
};

}  // namespace eigenlight::reference
