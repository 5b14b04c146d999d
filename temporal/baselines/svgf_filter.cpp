#include "temporal/baselines/svgf_filter.h"

#include <algorithm>
#include <cmath>

#include "frame/usable_surface.h"

namespace eigenlight {

void SvgfWeights::validate() const {
  EL_CHECK(depth_slopes > 0.0f && depth_slopes <= 100.0f, "depth_slopes {}: expected (0, 100]",
           depth_slopes);
  EL_CHECK(normal_squarings >= 0 && normal_squarings <= 10, "normal_squarings {}: expected 0 to 10",
           normal_squarings);
  EL_CHECK(luminance_sigmas > 0.0f && luminance_sigmas <= 100.0f,
           "luminance_sigmas {}: expected (0, 100]", luminance_sigmas);
}

float svgf_geometry_weight(const FrameInput& guides, const SvgfWeights& weights, glm::ivec2 p,
                           glm::ivec2 q) {
  const Camera& camera = guides.camera;
  const auto normal_at = [&](glm::ivec2 at) {
    const auto& n = guides.surface.normal;
    return glm::vec3(n[0](at.x, at.y), n[1](at.x, at.y), n[2](at.x, at.y));
  };
  const glm::vec3 normal = normal_at(p), view_normal = camera.world_to_view * normal;
  float facing = std::max(0.0f, glm::dot(normal, normal_at(q)));
  // Normals of another length and invalid depths would make weights grow.
  if (!std::islessequal(facing, kLargestCosine)) return 0.0f;
  for (int s = 0; s < weights.normal_squarings; ++s) facing *= facing;
  const float depth = std::max(guides.surface.depth(p.x, p.y), 0.0f);
  const float along = std::abs(glm::dot(view_normal, camera.pixel_to_view(glm::vec2(p) + 0.5f)));
  const glm::vec2 slope =
      glm::vec2(view_normal) * (depth / (camera.focal * std::max(along, 1e-3f)));
  const float apart = std::abs(guides.surface.depth(q.x, q.y) - depth);
  const float expected = weights.depth_slopes * std::abs(glm::dot(slope, glm::vec2(q - p)));
  return facing * std::exp(-apart / (expected + 1e-3f * depth));
}

}  // namespace eigenlight
