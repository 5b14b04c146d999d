// Frames for tests of antialiasing: guide rays whose hits are set by hand.
#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "frame/random.h"
#include "render/antialias/guide_map.h"

namespace eigenlight::test {

/// A frame that shows sky in each pixel until set() puts a surface there.
struct GuideFrame {
  explicit GuideFrame(Extent extent) : hits(extent), indirect(make_planes<3>(extent)) {
    frame.resize(extent);
    frame.surface.depth.fill(std::numeric_limits<float>::infinity());
  }

  struct Point {
    float depth = 1.0f;
    glm::vec3 normal{0, 0, -1};
    glm::vec3 indirect{0.0f}, direct{0.0f};
  };

  void set(int x, int y, const Point& point) {
    hits(x, y).kind = GuideHit::Kind::kSurface;
    frame.surface.id(x, y) = 1;
    frame.surface.depth(x, y) = point.depth;
    store_pixel(point.normal, x, y, frame.surface.normal);
    store_pixel(glm::vec3(1.0f), x, y, frame.surface.albedo);
    store_pixel(point.direct, x, y, frame.direct);
    store_pixel(point.indirect, x, y, indirect);
  }
  void set_all(const Point& point) {
    for (int y = 0; y < hits.height(); ++y) {
      for (int x = 0; x < hits.width(); ++x) set(x, y, point);
    }
  }
  [[nodiscard]] GuideMap map() const { return {frame, hits, indirect, frame.direct}; }

  Frame frame;
  Plane<GuideHit> hits;
  Planes<3> indirect;
};

/// Random surfaces with some sky and some NaN light.
inline GuideFrame random_guides(Extent extent, std::uint32_t seed) {
  GuideFrame guides(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const auto unit = [&](std::uint32_t d) { return to_unit(hash_key(seed, x, y, d)); };
      if (unit(0) < 0.15f) continue;
      const glm::vec3 normal(unit(1) - 0.5f, unit(2) - 0.5f, -0.3f - unit(3));
      GuideFrame::Point point{1.0f + 0.3f * unit(4),
                              glm::normalize(normal),
                              {unit(5), unit(6), unit(7)},
                              {unit(8), 0.2f, unit(9)}};
      if (unit(10) < 0.1f) point.indirect.y = std::numeric_limits<float>::quiet_NaN();
      guides.set(x, y, point);
    }
  }
  return guides;
}

/// A random hit somewhere in the image, such as random_guides() has.
inline EyePoint random_eye(Extent extent, std::uint32_t seed) {
  const auto unit = [&](std::uint32_t d) { return to_unit(hash_key(seed, d, 99u)); };
  const glm::vec2 size(static_cast<float>(extent.width), static_cast<float>(extent.height));
  const glm::vec3 normal(unit(2) - 0.5f, unit(3) - 0.5f, -0.3f - unit(4));
  return {size * glm::vec2(unit(0), unit(1)), 1.0f + 0.3f * unit(5), glm::normalize(normal)};
}

}  // namespace eigenlight::test
