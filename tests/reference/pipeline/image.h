// Planes in double, for the twin of the whole pipeline.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "frame/frame.h"
#include "reproject/basis_field.h"

namespace eigenlight::twin {

struct Image {
  explicit Image(Extent size) : extent(size), values(size.pixels(), 0.0) {}
  explicit Image(const Plane<float>& plane) : Image(plane.extent()) {
    each([&](int x, int y) { (*this)(x, y) = static_cast<double>(plane(x, y)); });
  }
  [[nodiscard]] double& operator()(int x, int y) { return values[index(x, y)]; }
  [[nodiscard]] double operator()(int x, int y) const { return values[index(x, y)]; }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(extent.width) +
           static_cast<std::size_t>(x);
  }
  template <typename Body>
  void each(Body body) const {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) body(x, y);
    }
  }
  /// Visits the pixels up to `radius` away.
  template <typename Body>
  void each_around(glm::ivec2 p, int radius, Body body) const {
    for (int y = std::max(p.y - radius, 0); y <= std::min(p.y + radius, extent.height - 1); ++y) {
      for (int x = std::max(p.x - radius, 0); x <= std::min(p.x + radius, extent.width - 1); ++x) {
        body(x, y);
      }
    }
  }

  Extent extent;
  std::vector<double> values;
};

using Light = std::array<Image, 3>;

[[nodiscard]] inline Light make_light(Extent extent) {
  return {Image(extent), Image(extent), Image(extent)};
}

[[nodiscard]] inline double luminance(const Light& light, int x, int y) {
  return 0.2126 * light[0](x, y) + 0.7152 * light[1](x, y) + 0.0722 * light[2](x, y);
}

[[nodiscard]] inline Planes<3> rounded(const Light& light) {
  Planes<3> out = make_planes<3>(light[0].extent);
  for (std::size_t c = 0; c < 3; ++c) {
    light[c].each([&](int x, int y) { out[c](x, y) = static_cast<float>(light[c](x, y)); });
  }
  return out;
}

[[nodiscard]] inline Plane<float> rounded(const Image& image) {
  Plane<float> out(image.extent);
  image.each([&](int x, int y) { out(x, y) = static_cast<float>(image(x, y)); });
  return out;
}

/// All kMaxBases bases; those not in use are 0.
struct Bases {
  explicit Bases(Extent extent) : age(extent) {
    for (int k = 0; k < kMaxBases; ++k) values.push_back(make_light(extent));
  }
  [[nodiscard]] Light& operator[](int k) { return values[static_cast<std::size_t>(k)]; }
  [[nodiscard]] const Light& operator[](int k) const { return values[static_cast<std::size_t>(k)]; }
  [[nodiscard]] double dot(int i, int j, int x, int y) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) sum += (*this)[i][c](x, y) * (*this)[j][c](x, y);
    return sum;
  }

  std::vector<Light> values;
  Image age;
};

}  // namespace eigenlight::twin
