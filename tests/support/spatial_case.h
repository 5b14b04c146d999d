// Frames for spatial filters: tilted planes with sky and invalid light, and two walls that meet at
// an edge.
#pragma once

#include <cmath>
#include <limits>

#include "spatial/rivals/spatial_filter.h"
#include "tests/support/random_frames.h"

namespace eigenlight {

struct SpatialCase {
  /// Random planes, sky, light with NaN and Inf, weights of 0 and between 0.5 and 4.
  explicit SpatialCase(Extent extent)
      : frame(make_random_frame({.extent = extent}, 1)),
        signal(make_planes<3>(extent)),
        weight(random_plane(extent, 9, 0.5f, 4.0f)) {
    copy_planes(frame.lights[0].radiance, signal);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        if (PixelRandom(4, x, y).uniform() < 0.1f) weight(x, y) = 0.0f;
      }
    }
  }

  /// Two walls at right angles whose edge stands in the middle column, all of it usable.
  static SpatialCase corner(Extent extent) {
    SpatialCase c(extent);
    c.frame.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
    c.weight.fill(1.0f);
    c.frame.surface.id.fill(1);
    const float turn = std::sqrt(0.5f);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const bool left = 2 * x < extent.width;
        const glm::vec3 normal = glm::transpose(c.frame.camera.world_to_view) *
                                 glm::vec3(left ? turn : -turn, 0.0f, -turn);
        const glm::vec3 ray = c.frame.camera.pixel_to_view(glm::vec2(x, y) + 0.5f);
        // The edge is 5 away; both walls come nearer beside it.
        c.frame.surface.depth(x, y) = 5.0f / (1.0f + std::abs(ray.x));
        for (int i = 0; i < 3; ++i) {
          const auto plane = static_cast<std::size_t>(i);
          c.frame.surface.normal[plane](x, y) = normal[i];
          c.frame.surface.albedo[plane](x, y) = 0.5f;
          c.signal[plane](x, y) = 1.0f;
        }
      }
    }
    return c;
  }

  [[nodiscard]] Extent extent() const { return weight.extent(); }
  [[nodiscard]] SpatialInputs inputs() const { return {frame, signal, weight}; }
  [[nodiscard]] Planes<3> run(SpatialFilter& filter) const {
    Planes<3> out = make_planes<3>(extent());
    filter.process(inputs(), out);
    return out;
  }
  /// The guide image of filters that leave out values that are not finite.
  [[nodiscard]] bool is_usable(int x, int y) const {
    bool finite = true;
    for (const auto& plane : signal) finite = finite && std::isfinite(plane(x, y));
    return finite && weight(x, y) > 0.0f && frame.surface.id(x, y) != 0;
  }

  Frame frame;
  Planes<3> signal;
  Plane<float> weight;
};

}  // namespace eigenlight
