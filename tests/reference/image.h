// Images, bases and coefficients in double, with the interfaces of Plane, BasisField and
// CoefficientField: twins of stages take either.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "frame/frame.h"
#include "reproject/basis_field.h"
#include "temporal/bases/coefficients.h"

namespace eigenlight::reference {

class Image {
 public:
  explicit Image(Extent extent) : extent_(extent), values_(extent.pixels(), 0.0) {}
  explicit Image(const Plane<float>& plane) : Image(plane.extent()) {
    each([&](int x, int y) { (*this)(x, y) = static_cast<double>(plane(x, y)); });
  }
  [[nodiscard]] Extent extent() const { return extent_; }
  [[nodiscard]] double& operator()(int x, int y) { return values_[index(x, y)]; }
  [[nodiscard]] double operator()(int x, int y) const { return values_[index(x, y)]; }
  [[nodiscard]] const std::vector<double>& values() const { return values_; }  ///< row by row

  template <typename Body>
  void each(Body body) const {
    for (int y = 0; y < extent_.height; ++y) {
      for (int x = 0; x < extent_.width; ++x) body(x, y);
    }
  }
  /// Visits the pixels up to `radius` away.
  template <typename Body>
  void each_around(glm::ivec2 p, int radius, Body body) const {
    for (int y = std::max(p.y - radius, 0); y <= std::min(p.y + radius, extent_.height - 1); ++y) {
      for (int x = std::max(p.x - radius, 0); x <= std::min(p.x + radius, extent_.width - 1); ++x) {
        body(x, y);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(extent_.width) +
           static_cast<std::size_t>(x);
  }

  Extent extent_;
  std::vector<double> values_;
};

using LightImages = std::array<Image, 3>;

[[nodiscard]] inline LightImages make_light(Extent extent) {
  return {Image(extent), Image(extent), Image(extent)};
}

[[nodiscard]] inline LightImages to_double(const Planes<3>& planes) {
  return {Image(planes[0]), Image(planes[1]), Image(planes[2])};
}

[[nodiscard]] inline Plane<float> rounded(const Image& image) {
  Plane<float> out(image.extent());
  image.each([&](int x, int y) { out(x, y) = static_cast<float>(image(x, y)); });
  return out;
}

[[nodiscard]] inline Planes<3> rounded(const LightImages& light) {
  return {rounded(light[0]), rounded(light[1]), rounded(light[2])};
}

/// Bases and their age; those not in use are 0.
class Bases {
 public:
  Bases(Extent extent, int bases) : age(extent) {
    for (int k = 0; k < bases; ++k) values_.push_back(make_light(extent));
  }
  [[nodiscard]] int bases() const { return static_cast<int>(values_.size()); }
  [[nodiscard]] double& value(int x, int y, int channel, int k) { return basis(k, channel)(x, y); }
  [[nodiscard]] double value(int x, int y, int channel, int k) const {
    return values_[static_cast<std::size_t>(k)][static_cast<std::size_t>(channel)](x, y);
  }
  void clear_basis(int k) { values_[static_cast<std::size_t>(k)] = make_light(age.extent()); }

  Image age;

 private:
  [[nodiscard]] Image& basis(int k, int channel) {
    return values_[static_cast<std::size_t>(k)][static_cast<std::size_t>(channel)];
  }

  std::vector<LightImages> values_;
};

/// Coefficients of every tile as offsets from (1, 0, ..., 0).
class Coefficients {
 public:
  explicit Coefficients(Extent extent)
      : grid_(extent, kCoefficientTile, kCoefficientTile),
        values_(static_cast<std::size_t>(grid_.count())) {}
  [[nodiscard]] const TileGrid& grid() const { return grid_; }
  [[nodiscard]] std::array<double, kMaxBases>& tile(int index) {
    return values_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] const std::array<double, kMaxBases>& tile(int index) const {
    return values_[static_cast<std::size_t>(index)];
  }

 private:
  TileGrid grid_;
  std::vector<std::array<double, kMaxBases>> values_;
};

}  // namespace eigenlight::reference
