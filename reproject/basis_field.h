// All bases of a pixel side by side: what every temporal stage reads and writes.
#pragma once

#include "frame/plane.h"

namespace eigenlight {

inline constexpr int kMaxBases = 8;

/// K bases of an RGB image, pixel-interleaved, with the pixel's age behind them:
/// [y][x] { [channel][k] 3 K floats, age, zeros up to a multiple of 4 floats }.
///
/// Interleaved because a warp fetches whole pixels from anywhere; the age travels through the same
/// taps as the values it belongs to. Zero without history.
class BasisField {
 public:
  BasisField() = default;
  /// Throws std::invalid_argument unless `bases` is in [1, kMaxBases].
  BasisField(Extent extent, int bases) : bases_(bases) {
    check_bases(bases);
    data_ = Plane<float>(extent, pixel_floats(bases));
  }

  /// Makes room for another number of bases; what the pixels held is lost if it differs.
  /// Throws std::invalid_argument unless it is in [1, kMaxBases].
  void reshape(int bases) {
    if (bases == bases_) return;
    check_bases(bases);
    bases_ = bases;
    data_.reshape(pixel_floats(bases));
  }

  /// Floats from one pixel to the next for K bases.
  [[nodiscard]] static constexpr int pixel_floats(int bases) { return (3 * bases + 1 + 3) / 4 * 4; }

  [[nodiscard]] int bases() const { return bases_; }
  [[nodiscard]] int pixel_floats() const { return data_.channels(); }
  [[nodiscard]] Extent extent() const { return data_.extent(); }
  [[nodiscard]] float* pixel(int x, int y) { return data_.at(x, y); }
  [[nodiscard]] const float* pixel(int x, int y) const { return data_.at(x, y); }
  [[nodiscard]] float& value(int x, int y, int channel, int k) {
    return data_.at(x, y)[channel * bases_ + k];
  }
  [[nodiscard]] float value(int x, int y, int channel, int k) const {
    return data_.at(x, y)[channel * bases_ + k];
  }
  [[nodiscard]] float& age(int x, int y) { return data_.at(x, y)[3 * bases_]; }
  [[nodiscard]] float age(int x, int y) const { return data_.at(x, y)[3 * bases_]; }

  [[nodiscard]] Plane<float>& data() { return data_; }
  [[nodiscard]] const Plane<float>& data() const { return data_; }

 private:
  static void check_bases(int bases) {
    EL_CHECK(bases >= 1 && bases <= kMaxBases, "bases {}: expected 1 to {}", bases, kMaxBases);
  }

  int bases_ = 1;
  Plane<float> data_;
};

}  // namespace eigenlight
