// Scenes for tests of the a-trous filter.
#pragma once

#include <limits>

#include "spatial/atrous.h"
#include "tests/reference/atrous.h"
#include "tests/support/random_frames.h"

namespace eigenlight::test {

/// A random frame with light, variance and an earlier picture.
struct AtrousScene {
  explicit AtrousScene(Extent extent, bool sky = true)
      : guides(make_random_frame({.extent = extent, .sky = sky, .non_finite = false}, 2)),
        color(make_planes<3>(extent)),
        variance(random_plane(extent, 5, 0.01f, 0.3f)),
        earlier(random_plane(extent, 6, 0.3f, 1.5f)) {
    copy_planes(guides.lights[0].radiance, color);
    forget_some();
  }
  /// A wall that faces the camera.
  static AtrousScene wall(Extent extent) {
    AtrousScene scene(extent, false);
    scene.guides.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
    scene.guides.surface.id.fill(1);
    scene.guides.surface.depth.fill(4.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      scene.guides.surface.normal[c].fill(c == 2 ? -1.0f : 0.0f);
    }
    return scene;
  }
  std::int64_t run(const AtrousOptions& options = {}, float quiet = 0.0f) {
    Atrous atrous(variance.extent(), options);
    return atrous.process(guides, quiet, color, variance);
  }
  /// Makes the earlier picture unknown at one pixel in thirteen.
  void forget_some() {
    for (int y = 0; y < earlier.height(); ++y) {
      for (int x = 0; x < earlier.width(); ++x) {
        if ((x + 5 * y) % 13 == 0) earlier(x, y) = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  void run_with_earlier(const AtrousOptions& options = {}) {
    Atrous atrous(variance.extent(), options);
    atrous.process(guides, 0.0f, color, variance, &earlier);
  }
  [[nodiscard]] reference::Earlier earlier_values() const {
    reference::Earlier values;
    for (int y = 0; y < earlier.height(); ++y) {
      values.insert(values.end(), earlier.row(y), earlier.row(y) + earlier.width());
    }
    return values;
  }
  /// Fills color with one value left of the middle column and another one from there on.
  void set_halves(float left, float right) {
    for (auto& plane : color) {
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) {
          plane(x, y) = x < plane.width() / 2 ? left : right;
        }
      }
    }
  }
  Frame guides;
  Planes<3> color;
  Plane<float> variance, earlier;
};

}  // namespace eigenlight::test
