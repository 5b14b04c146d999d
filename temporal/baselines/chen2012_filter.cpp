#include "temporal/baselines/chen2012_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "frame/usable_surface.h"

namespace eigenlight {
namespace {

constexpr int kRadius = 5;
constexpr float kSigma = 2.5f;
constexpr float kPlaneDistance = 0.02f;

using Values = std::array<float, 3 * kMaxBases>;

glm::vec3 normal_at(const FrameInput& frame, glm::ivec2 p) {
  const auto& n = frame.surface.normal;
  return {n[0](p.x, p.y), n[1](p.x, p.y), n[2](p.x, p.y)};
}

glm::vec3 point_at(const FrameInput& frame, glm::ivec2 p) {
  return frame.camera.pixel_to_view(glm::vec2(p) + 0.5f) * frame.surface.depth(p.x, p.y);
}

// What the pixel in the middle compares its neighbors with.
class Center {
 public:
  Center(const FrameInput& frame, glm::ivec2 pixel)
      : frame_(frame),
        pixel_(pixel),
        normal_(normal_at(frame, pixel)),
        point_(point_at(frame, pixel)),
        across_(frame.camera.world_to_view * normal_ /
                (kPlaneDistance * frame.surface.depth(pixel.x, pixel.y))) {}

  [[nodiscard]] float weight(glm::ivec2 q) const {
    float facing = std::clamp(glm::dot(normal_, normal_at(frame_, q)), 0.0f, 1.0f);
    for (int i = 0; i < 6; ++i) facing *= facing;  // to the power of 64
    const float plane = std::abs(glm::dot(across_, point_at(frame_, q) - point_));
    const glm::vec2 step(q - pixel_);
    return facing * std::exp(-glm::dot(step, step) / (2.0f * kSigma * kSigma) - plane);
  }

 private:
  const FrameInput& frame_;
  glm::ivec2 pixel_;
  glm::vec3 normal_, point_;
  glm::vec3 across_;  // its product with a distance is that off the plane, in units of the bound
};

Values values_at(const BasisField& bases, int x, int y) {
  Values values{};
  for (int k = 0; k < bases.bases(); ++k) {
    for (int c = 0; c < 3; ++c)
      values[static_cast<std::size_t>(3 * k + c)] = bases.value(x, y, c, k);
  }
  return values;
}

Values filter_pixel(const FrameInput& frame, const BasisField& bases, glm::ivec2 p) {
  const auto count = static_cast<std::size_t>(3 * bases.bases());
  const Values own = values_at(bases, p.x, p.y);
  if (!is_usable_surface(frame.surface, p.x, p.y)) return own;
  Values sum{};
  const Center center(frame, p);
  float weights = 0.0f;
  for (int y = p.y - kRadius; y <= p.y + kRadius; ++y) {
    for (int x = p.x - kRadius; x <= p.x + kRadius; ++x) {
      if (!bases.extent().contains(x, y) || !is_usable_surface(frame.surface, x, y)) continue;
      if (!(bases.age(x, y) > 0.0f)) continue;
      const float w = center.weight({x, y});
      if (!(w > 0.0f)) continue;
      weights += w;
      const Values values = values_at(bases, x, y);
      for (std::size_t i = 0; i < count; ++i) sum[i] += w * values[i];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    sum[i] = weights > 0.0f ? sum[i] / weights : own[i];
  }
  return sum;
}

}  // namespace

NewPixelFilter::NewPixelFilter(Extent extent)
    : tiles_(stage_tiles(extent)), filtered_(static_cast<std::size_t>(tiles_.count())) {}

void NewPixelFilter::process(const FrameInput& frame, const Plane<std::uint8_t>& smooth,
                             BasisField& bases) {
  EL_CHECK(frame.extent() == tiles_.extent() && smooth.extent() == tiles_.extent() &&
               bases.extent() == tiles_.extent(),
           "basis filter made for {}x{}: got planes of another size", tiles_.extent().width,
           tiles_.extent().height);
  const auto for_marked = [&](const Tile& tile, const auto& visit) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        if (smooth(x, y) != 0) visit(x, y);
      }
    }
  };
  const int count = 3 * bases.bases();
  for_each_tile(tiles_, [&](const Tile& tile) {
    auto& filtered = filtered_[static_cast<std::size_t>(tile.index)];
    filtered.clear();
    for_marked(tile, [&](int x, int y) {
      const Values values = filter_pixel(frame, bases, {x, y});
      filtered.insert(filtered.end(), values.begin(), values.begin() + count);
    });
  });
  // Written only now, because windows of other tiles read these pixels.
  for_each_tile(tiles_, [&](const Tile& tile) {
    const float* next = filtered_[static_cast<std::size_t>(tile.index)].data();
    for_marked(tile, [&](int x, int y) {
      for (int k = 0; k < bases.bases(); ++k) {
        for (int c = 0; c < 3; ++c) bases.value(x, y, c, k) = *next++;
      }
    });
  });
}

}  // namespace eigenlight
