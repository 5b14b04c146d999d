// A room corner for tests of the guided filter.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/random.h"
#include "spatial/guided_filter.h"

namespace eigenlight::test {

/// Random numbers in [0, 1); `what` tells sequences apart.
inline float random(int x, int y, std::uint32_t what) {
  return to_unit(hash_key(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), what));
}

/// Two walls that meet at a vertical edge, boxes in front of them, noisy light, some sky, and
/// pixels without a sample.
struct GuidedCase {
  explicit GuidedCase(Extent size)
      : extent(size), signal(make_planes<3>(size)), weight(size), wanted(size) {
    frame.resize(size);
    wanted.fill(1);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) fill(x, y);
    }
  }

  void fill(int x, int y) {
    const bool left = 2 * x < extent.width;
    const bool box = (x / 11 + y / 7) % 3 == 0;
    auto& s = frame.surface;
    s.id(x, y) = random(x / 9, y / 9, 1) < 0.9f ? 1 : 0;
    s.depth(x, y) = box ? 3.0f + 0.01f * static_cast<float>(y)
                        : 6.0f + 0.02f * static_cast<float>(left ? x : extent.width - x);
    if (s.id(x, y) == 0) s.depth(x, y) = std::numeric_limits<float>::infinity();
    const float normal[3] = {left ? 0.8f : -0.8f, 0.0f, 0.6f};
    for (std::size_t c = 0; c < 3; ++c) {
      s.normal[c](x, y) = box ? (c == 1 ? 1.0f : 0.0f) : normal[c];
      signal[c](x, y) =
          (left ? 1.0f : 0.3f) * (0.2f + 1.6f * random(x, y, 10 + static_cast<std::uint32_t>(c)));
    }
    weight(x, y) = random(x, y, 2) < 0.2f ? 0.0f : 8.0f * random(x, y, 3);
  }

  [[nodiscard]] GuidedInputs inputs() const { return {frame, signal, weight, wanted}; }

  [[nodiscard]] Planes<3> filter(const GuidedOptions& options = {}) const {
    Planes<3> out = make_planes<3>(extent);
    EXPECT_EQ(GuidedFilter(extent, options).process(inputs(), out), 0);
    return out;
  }

  void flat_wall() {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        frame.surface.id(x, y) = 1;
        frame.surface.depth(x, y) = 5.0f;
        for (std::size_t c = 0; c < 3; ++c) frame.surface.normal[c](x, y) = c == 2 ? 1.0f : 0.0f;
        weight(x, y) = 1.0f;
      }
    }
  }

  Extent extent;
  Frame frame;
  Planes<3> signal;
  Plane<float> weight;
  Plane<std::uint8_t> wanted;
};

/// Largest difference of two images; NaN if one of them has NaN.
inline double distance(const Planes<3>& a, const Planes<3>& b) {
  double most = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        const double d = std::abs(static_cast<double>(a[c](x, y)) - b[c](x, y));
        if (!(d <= most)) most = d;
      }
    }
  }
  return most;
}

}  // namespace eigenlight::test
