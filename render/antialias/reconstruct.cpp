#include "render/antialias/reconstruct.h"

#include <cmath>

namespace eigenlight {
namespace {

float fall_off(float x) { return std::exp(-x * x); }

float weight(const GuideMap& guides, const EyePoint& eye, glm::ivec2 at) {
  const float dz = guides.depth(at.x, at.y) - eye.depth;
  const float cosine = glm::clamp(glm::dot(eye.normal, guides.normal(at.x, at.y)), 0.0f, 1.0f);
  return fall_off(kSigmaZ * dz) * fall_off(kSigmaN * (1.0f - cosine));
}

}  // namespace

std::optional<glm::vec3> reconstruct_light(const GuideMap& guides, const Plane<std::uint8_t>& lit,
                                           const EyePoint& eye, std::uint8_t eye_lit) {
  const glm::ivec2 low(glm::ceil(eye.pixel - 0.5f - kReconstructRadius));
  const glm::ivec2 high(glm::floor(eye.pixel - 0.5f + kReconstructRadius));
  glm::dvec3 sum(0.0);
  double weights = 0.0;
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      const glm::vec2 step = eye.pixel - glm::vec2(x, y) - 0.5f;
      if (glm::dot(step, step) > kReconstructRadius * kReconstructRadius) continue;
      if (!guides.is_surface(x, y) || lit(x, y) != eye_lit) continue;
      const glm::vec3 light = guides.light(x, y);
      if (!is_finite(light)) continue;
      const double w = static_cast<double>(weight(guides, eye, {x, y}));
      sum += w * glm::dvec3(light);
      weights += w;
    }
  }
  if (weights < static_cast<double>(kLeastWeight)) return std::nullopt;
  return glm::vec3(sum / weights);
}

}  // namespace eigenlight
