// Sizes of images.
#pragma once

#include <cstddef>

#include "frame/check.h"

namespace eigenlight {

/// Size of an image in pixels. Valid images have both sides in [1, 65536].
struct Extent {
  int width = 0;
  int height = 0;

  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] bool contains(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height;
  }
  friend bool operator==(const Extent&, const Extent&) = default;
};

inline constexpr int kMaxSide = 65536;

/// Throws std::invalid_argument unless both sides of `extent` are in [1, kMaxSide].
inline void check_extent(Extent extent) {
  EL_CHECK(extent.width >= 1 && extent.height >= 1 && extent.width <= kMaxSide &&
               extent.height <= kMaxSide,
           "image size {}x{}: each side must be in [1, {}]", extent.width, extent.height, kMaxSide);
}

}  // namespace eigenlight
