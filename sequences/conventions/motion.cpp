#include "sequences/conventions/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/check.h"
#include "frame/tiles.h"
#include "sequences/conventions/background.h"

namespace eigenlight {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct VectorPlanes {
  const Plane<float>&x, &y;
  glm::vec2 scale;

  VectorPlanes(const RawGuides& guides, const MotionReading& reading)
      : x(plane(guides, reading, 0)),
        y(plane(guides, reading, 1)),
        scale(static_cast<float>(reading.scale_x), static_cast<float>(reading.scale_y)) {}

  [[nodiscard]] glm::vec2 at(int i, int j) const { return scale * glm::vec2(x(i, j), y(i, j)); }

 private:
  static const Plane<float>& plane(const RawGuides& guides, const MotionReading& reading,
                                   std::size_t axis) {
    const std::size_t channel = reading.pair == 0 ? axis : 2 + axis;
    EL_CHECK(channel < guides.motion.size(),
             "motion: channels {} and {} were asked for, but frame {} has {} of them",
             reading.pair == 0 ? 1 : 3, reading.pair == 0 ? 2 : 4, guides.frame,
             guides.motion.size());
    return guides.motion[channel];
  }
};

bool is_finite(const glm::vec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }

// Beyond it no picture is, and float still counts pixels.
constexpr float kFarAway = 1e6f;

// Pixels from where a vector lands to the pixels that it covers: half a diagonal, and a little more
// for surfaces that come nearer.
constexpr float kReach = 0.8f;

// What has landed on a pixel, and where of its square.
struct Landed {
  float depth = kInfinity, distance = kInfinity;
};

// Whether a point takes the pixel from what has landed there: nearer by 1 %, or closer to the
// center at about the same depth.
bool is_in_front(const Landed& now, const Landed& there) {
  if (!std::isfinite(there.distance)) return true;
  if (!std::isfinite(now.depth) || !std::isfinite(there.depth)) {
    return now.depth != there.depth ? now.depth < there.depth : now.distance < there.distance;
  }
  if (now.depth < 0.99f * there.depth) return true;
  return now.depth < 1.01f * there.depth && now.distance < there.distance;
}

void splat(const RawGuides& before, const VectorPlanes& vectors, Planes<2>& motion) {
  const Extent extent = motion[0].extent();
  Plane<Landed> landed(extent);
  landed.fill(Landed{});
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const glm::vec2 vector = vectors.at(x, y);
      if (!is_finite(vector) || std::abs(vector.x) > kFarAway || std::abs(vector.y) > kFarAway) {
        continue;
      }
      const glm::vec2 to = glm::vec2(static_cast<float>(x), static_cast<float>(y)) - vector;
      const float raw = before.depth.empty() ? 0.0f : before.depth(x, y);
      const float depth = before.depth.empty() || !is_background(raw) ? raw : kInfinity;
      const int x0 = static_cast<int>(std::floor(to.x)), y0 = static_cast<int>(std::floor(to.y));
      for (int j = y0; j <= y0 + 1; ++j) {
        for (int i = x0; i <= x0 + 1; ++i) {
          if (!extent.contains(i, j)) continue;
          const glm::vec2 off = to - glm::vec2(static_cast<float>(i), static_cast<float>(j));
          const Landed now{depth, glm::dot(off, off)};
          if (now.distance > kReach * kReach || !is_in_front(now, landed(i, j))) continue;
          landed(i, j) = now;
          motion[0](i, j) = vector.x;
          motion[1](i, j) = vector.y;
        }
      }
    }
  }
}

glm::vec2 center_of(int x, int y) {
  return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
}

// Where a static point was: the vector, and its depth there.
struct StaticPoint {
  glm::vec2 motion{kUnknown};
  float depth = 0.0f;
};

StaticPoint static_point(const glm::vec2& pixel, float depth, const Camera& now,
                         const Camera& before) {
  const bool is_sky = !std::isfinite(depth);
  const glm::vec3 view = now.pixel_to_view(pixel) * (is_sky ? 1.0f : depth);
  // In double: places of large worlds differ in few digits.
  const glm::dvec3 world = glm::transpose(glm::dmat3(now.world_to_view)) * glm::dvec3(view);
  const glm::dvec3 step = is_sky ? glm::dvec3(0.0) : glm::dvec3(now.eye) - glm::dvec3(before.eye);
  const glm::vec3 there(glm::dmat3(before.world_to_view) * (world + step));
  if (there.z <= 1e-6f * glm::length(there)) return {};
  return {before.view_to_pixel(there) - pixel, is_sky ? kInfinity : there.z};
}

// Depths of one surface within a pixel: more than that is another one.
constexpr float kSameSurface = 0.05f;

// Bilinear between the four pixels around a place, of which those count that are of one surface
// with the one nearest to `depth`; 0 outside.
float found_depth(const Plane<float>& plane, const glm::vec2& place, float depth) {
  const auto width = static_cast<float>(plane.width()), height = static_cast<float>(plane.height());
  if (place.x < 0.0f || place.y < 0.0f || place.x > width || place.y > height) return 0.0f;
  const glm::vec2 corner = glm::floor(place - 0.5f), inside = place - 0.5f - corner;
  const int x0 = static_cast<int>(corner.x), y0 = static_cast<int>(corner.y);
  float depths[4] = {}, weights[4] = {}, best = 0.0f, best_ratio = kInfinity;
  for (int k = 0; k < 4; ++k) {
    const int x = x0 + (k & 1), y = y0 + (k >> 1);
    if (!plane.extent().contains(x, y) || is_background(plane(x, y))) continue;
    depths[k] = plane(x, y);
    weights[k] =
        ((k & 1) != 0 ? inside.x : 1.0f - inside.x) * ((k >> 1) != 0 ? inside.y : 1.0f - inside.y);
    const float ratio = std::max(depths[k] / depth, depth / depths[k]);
    if (ratio >= best_ratio) continue;
    best = depths[k];
    best_ratio = ratio;
  }
  float sum = 0.0f, weight = 0.0f;
  for (int k = 0; k < 4; ++k) {
    if (std::abs(depths[k] - best) > kSameSurface * best) continue;
    sum += weights[k] * depths[k];
    weight += weights[k];
  }
  return weight > 1e-3f ? sum / weight : best;
}

}  // namespace

void apply_motion(const RawGuides& now, const RawGuides* before, const MotionReading& reading,
                  Planes<2>& motion) {
  const Extent extent = now.extent();
  check_extent(extent);
  ensure_extent(motion, extent);
  if (reading.backward) {
    const VectorPlanes vectors(now, reading);
    for_each_tile(stage_tiles(extent), [&](const Tile& tile) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
          const glm::vec2 vector = vectors.at(x, y);
          const bool good = is_finite(vector);
          motion[0](x, y) = good ? vector.x : kUnknown;
          motion[1](x, y) = good ? vector.y : kUnknown;
        }
      }
    });
    return;
  }
  motion[0].fill(kUnknown);
  motion[1].fill(kUnknown);
  if (before == nullptr || before->motion.empty() || before->extent() != extent) return;
  splat(*before, VectorPlanes(*before, reading), motion);
}

void motion_from_cameras(const Plane<float>& depth, const Camera& now, const Camera& before,
                         Planes<2>& motion, Plane<float>& previous_depth) {
  ensure_extent(motion, depth.extent());
  ensure_extent(previous_depth, depth.extent());
  for_each_tile(stage_tiles(depth.extent()), [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const StaticPoint point = static_point(center_of(x, y), depth(x, y), now, before);
        motion[0](x, y) = point.motion.x;
        motion[1](x, y) = point.motion.y;
        previous_depth(x, y) = point.depth;
      }
    }
  });
}

void previous_depth_of(const Planes<2>& motion, const Plane<float>& depth,
                       const Plane<float>& depth_before, const CameraPair* cameras,
                       Plane<float>& previous_depth) {
  const Extent extent = depth.extent();
  EL_CHECK(motion[0].extent() == extent && depth_before.extent() == extent,
           "previous depth: motion is {}x{}, depth {}x{}, depth before {}x{}; expected one size",
           motion[0].width(), motion[0].height(), extent.width, extent.height, depth_before.width(),
           depth_before.height());
  ensure_extent(previous_depth, extent);
  for_each_tile(stage_tiles(extent), [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const glm::vec2 vector(motion[0](x, y), motion[1](x, y)), pixel = center_of(x, y);
        float& result = previous_depth(x, y);
        if (is_background(depth(x, y))) {
          result = kInfinity;
          continue;
        }
        result = 0.0f;
        if (!is_finite(vector)) continue;
        if (cameras != nullptr) {
          const StaticPoint point = static_point(pixel, depth(x, y), cameras->now, cameras->before);
          const float allowed = 0.25f + 0.02f * glm::length(vector);
          if (point.depth > 0.0f && glm::length(point.motion - vector) <= allowed) {
            result = point.depth;
            continue;
          }
        }
        result = found_depth(depth_before, pixel + vector, depth(x, y));
      }
    }
  });
}

}  // namespace eigenlight
