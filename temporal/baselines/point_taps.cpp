#include "temporal/baselines/point_taps.h"

#include <cmath>
#include <limits>

namespace eigenlight {

TapRule::TapRule(const PreviousSurface& earlier, const TapOptions& options,
                 const SoughtPoint& point)
    : earlier_(earlier),
      options_(options),
      point_(point),
      view_normal_(earlier.camera.world_to_view * point.normal),
      plane_(point.depth *
             glm::dot(view_normal_, earlier.camera.pixel_to_view(point.pixel + 0.5f))),
      // Comparisons with NaN are false.
      sound_(point.id != 0 && point.depth > 0.0f &&
             point.depth < std::numeric_limits<float>::max() && std::isfinite(plane_)) {}

bool TapRule::accepts(int x, int y) const {
  const GBuffer& surface = earlier_.surface;
  if (!sound_ || !surface.depth.extent().contains(x, y)) return false;
  if (surface.id(x, y) != point_.id) return false;
  const glm::vec3 ray = earlier_.camera.pixel_to_view(glm::vec2(x, y) + 0.5f);
  const float distance = std::abs(surface.depth(x, y) * glm::dot(view_normal_, ray) - plane_);
  const glm::vec3 normal(surface.normal[0](x, y), surface.normal[1](x, y), surface.normal[2](x, y));
  return distance <= options_.plane_distance * point_.depth &&
         glm::dot(point_.normal, normal) >= options_.normal_cosine;
}

PointTaps point_taps(const PreviousSurface& earlier, const TapOptions& options,
                     const SoughtPoint& point) {
  PointTaps taps;
  const Extent extent = earlier.surface.depth.extent();
  const bool near = point.pixel.x > -1.0f && point.pixel.y > -1.0f &&
                    point.pixel.x < static_cast<float>(extent.width) &&
                    point.pixel.y < static_cast<float>(extent.height);
  if (!near) return taps;
  const glm::vec2 corner = glm::floor(point.pixel), fraction = point.pixel - corner;
  taps.corner = glm::ivec2(corner);
  const TapRule rule(earlier, options, point);
  float sum = 0.0f;
  for (std::size_t t = 0; t < 4; ++t) {
    const float across = t % 2 == 1 ? fraction.x : 1.0f - fraction.x;
    const float down = t / 2 == 1 ? fraction.y : 1.0f - fraction.y;
    const glm::ivec2 tap = taps.tap(t);
    if (!(across * down > 0.0f) || !rule.accepts(tap.x, tap.y)) continue;
    taps.weight[t] = across * down;
    sum += taps.weight[t];
  }
  for (float& weight : taps.weight) weight = sum >= 0.01f ? weight / sum : 0.0f;
  return taps;
}

}  // namespace eigenlight
