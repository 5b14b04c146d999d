// Compares planes and says which pixel differs first.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "frame/plane.h"

namespace eigenlight {

/// |a - b| <= relative * |b| + absolute at every pixel, and no NaN in either.
struct Tolerance {
  double relative = 1e-5;
  double absolute = 0.0;
};

[[nodiscard]] inline ::testing::AssertionResult planes_near(const Plane<float>& found,
                                                            const Plane<float>& wanted,
                                                            Tolerance tolerance) {
  if (found.extent() != wanted.extent() || found.channels() != wanted.channels()) {
    return ::testing::AssertionFailure() << "planes differ in shape";
  }
  for (int y = 0; y < found.height(); ++y) {
    for (int x = 0; x < found.width(); ++x) {
      for (int c = 0; c < found.channels(); ++c) {
        const double a = found.at(x, y)[c], b = wanted.at(x, y)[c];
        if (std::abs(a - b) <= tolerance.relative * std::abs(b) + tolerance.absolute) continue;
        return ::testing::AssertionFailure()
               << "pixel (" << x << ", " << y << ") value " << c << ": " << a << ", expected " << b;
      }
    }
  }
  return ::testing::AssertionSuccess();
}

template <std::size_t N>
[[nodiscard]] ::testing::AssertionResult planes_near(const Planes<N>& found,
                                                     const Planes<N>& wanted, Tolerance tolerance) {
  for (std::size_t c = 0; c < N; ++c) {
    const auto result = planes_near(found[c], wanted[c], tolerance);
    if (!result) return ::testing::AssertionFailure() << "plane " << c << ": " << result.message();
  }
  return ::testing::AssertionSuccess();
}

/// The same bits at every pixel; padding does not count.
[[nodiscard]] inline ::testing::AssertionResult planes_equal(const Plane<float>& found,
                                                             const Plane<float>& wanted) {
  if (found.extent() != wanted.extent() || found.channels() != wanted.channels()) {
    return ::testing::AssertionFailure() << "planes differ in shape";
  }
  for (int y = 0; y < found.height(); ++y) {
    for (int i = 0; i < found.width() * found.channels(); ++i) {
      const float a = found.row(y)[i], b = wanted.row(y)[i];
      if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b)) continue;
      return ::testing::AssertionFailure()
             << "pixel (" << i / found.channels() << ", " << y << "): " << a << ", expected " << b;
    }
  }
  return ::testing::AssertionSuccess();
}

template <std::size_t N>
[[nodiscard]] ::testing::AssertionResult planes_equal(const Planes<N>& found,
                                                      const Planes<N>& wanted) {
  for (std::size_t c = 0; c < N; ++c) {
    const auto result = planes_equal(found[c], wanted[c]);
    if (!result) return ::testing::AssertionFailure() << "plane " << c << ": " << result.message();
  }
  return ::testing::AssertionSuccess();
}

}  // namespace eigenlight
