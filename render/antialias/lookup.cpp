#include "render/antialias/lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace eigenlight {
namespace {

struct Candidate {
  glm::ivec2 at{0};
  float normal_distance2 = 0.0f;
  float depth_distance = 0.0f;
  float image_distance2 = 0.0f;
};

// At most four candidates in row order.
struct Candidates {
  std::array<Candidate, 4> list;
  std::size_t count = 0;
  float max_normal_distance2 = 0.0f;
  float max_depth_distance = 0.0f;

  void add(const Candidate& c) {
    list[count++] = c;
    max_normal_distance2 = std::max(max_normal_distance2, c.normal_distance2);
    max_depth_distance = std::max(max_depth_distance, c.depth_distance);
  }
  [[nodiscard]] float similarity(const Candidate& c) const {
    const auto part = [](float distance, float most) {
      return most > 0.0f ? 1.0f - distance / most : 1.0f;
    };
    return part(c.normal_distance2, max_normal_distance2) *
           part(c.depth_distance, max_depth_distance);
  }
};

Candidate compare(const GuideMap& guides, const EyePoint& eye, glm::ivec2 at) {
  const glm::vec3 turn = eye.normal - guides.normal(at.x, at.y);
  const glm::vec2 step = eye.pixel - (glm::vec2(at) + 0.5f);
  return {at, glm::dot(turn, turn), std::abs(eye.depth - guides.depth(at.x, at.y)),
          glm::dot(step, step)};
}

}  // namespace

std::optional<glm::ivec2> most_similar_guide(const GuideMap& guides, const EyePoint& eye,
                                             const SeenAlike* seen) {
  const glm::ivec2 corner(glm::floor(eye.pixel - 0.5f));
  Candidates candidates;
  for (int i = 0; i < 4; ++i) {
    const glm::ivec2 at = corner + glm::ivec2(i % 2, i / 2);
    if (!guides.is_surface(at.x, at.y)) continue;
    if (!is_finite(guides.indirect_light(at.x, at.y))) continue;
    if (seen && seen->values(at.x, at.y) != seen->value) continue;
    candidates.add(compare(guides, eye, at));
  }
  std::optional<glm::ivec2> best;
  float best_similarity = 0.0f, best_distance2 = 0.0f;
  for (std::size_t i = 0; i < candidates.count; ++i) {
    const Candidate& c = candidates.list[i];
    const float similarity = candidates.similarity(c);
    const bool ties = similarity == best_similarity && c.image_distance2 < best_distance2;
    if (best && !(similarity > best_similarity) && !ties) continue;
    best = c.at;
    best_similarity = similarity;
    best_distance2 = c.image_distance2;
  }
  return best;
}

}  // namespace eigenlight
