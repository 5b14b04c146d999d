#include "render/antialias/reconstruct.h"

#include <cmath>
#include <cstdlib>

namespace eigenlight {
namespace {

float fall_off(float x) { return std::exp(-x * x); }

float env(const char* n, float d) {
  const char* v = std::getenv(n);
  return v ? static_cast<float>(std::atof(v)) : d;
}
const float R = env("AA_R", 1.0f), SZ = env("AA_SZ", 10.0f), SN = env("AA_SN", 0.25f),
            LW = env("AA_LW", 0.05f);
const int REL = static_cast<int>(env("AA_REL", 0)), PLANE = static_cast<int>(env("AA_PLANE", 0)),
          SH = static_cast<int>(env("AA_SH", 1));

float weight(const GuideMap& guides, const EyePoint& eye, glm::ivec2 at) {
  float dz = guides.depth(at.x, at.y) - eye.depth;
  if (REL) dz /= eye.depth;
  const float cosine = glm::clamp(glm::dot(eye.normal, guides.normal(at.x, at.y)), 0.0f, 1.0f);
  return fall_off(SZ * dz) * fall_off(SN * (1.0f - cosine));
}

}  // namespace

std::optional<glm::vec3> reconstruct_light(const GuideMap& guides, const Plane<std::uint8_t>& lit,
                                           const EyePoint& eye, std::uint8_t eye_lit) {
  const glm::ivec2 low(glm::ceil(eye.pixel - 0.5f - R));
  const glm::ivec2 high(glm::floor(eye.pixel - 0.5f + R));
  glm::dvec3 sum(0.0);
  double weights = 0.0;
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      const glm::vec2 step = eye.pixel - glm::vec2(x, y) - 0.5f;
      if (glm::dot(step, step) > R * R) continue;
      if (!guides.is_surface(x, y) || (SH && lit(x, y) != eye_lit)) continue;
      const glm::vec3 light = guides.light(x, y);
      if (!is_finite(light)) continue;
      const double w = static_cast<double>(weight(guides, eye, {x, y}));
      sum += w * glm::dvec3(light);
      weights += w;
    }
  }
  if (weights < static_cast<double>(LW)) return std::nullopt;
  return glm::vec3(sum / weights);
}

}  // namespace eigenlight
