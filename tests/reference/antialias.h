// Twins of render/antialias: lookup and reconstruction in double over the whole image, from the
// formulas in the headers.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "render/antialias/reconstruct.h"

namespace eigenlight::reference {

struct SimilarGuide {
  glm::ivec2 at{0};
  double similarity = 0.0;
  double distance2 = 0.0;  ///< pixels, squared
};

/// All candidates, the most similar first. Those nearer than one pixel in x and in y are the four
/// nearest guide rays.
inline std::vector<SimilarGuide> similar_guides(const GuideMap& guides, const EyePoint& eye) {
  std::vector<SimilarGuide> found;
  std::vector<double> normal, depth;
  const Extent extent = guides.frame.extent();
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const glm::dvec2 step = glm::dvec2(eye.pixel) - glm::dvec2(x + 0.5, y + 0.5);
      if (!(step.x < 1.0 && step.x >= -1.0 && step.y < 1.0 && step.y >= -1.0)) continue;
      if (step.x == -1.0 || step.y == -1.0) continue;
      if (!guides.is_surface(x, y) || !is_finite(guides.indirect_light(x, y))) continue;
      const glm::dvec3 turn = glm::dvec3(eye.normal) - glm::dvec3(guides.normal(x, y));
      normal.push_back(glm::dot(turn, turn));
      depth.push_back(std::abs(static_cast<double>(eye.depth) - guides.depth(x, y)));
      found.push_back({{x, y}, 0.0, glm::dot(step, step)});
    }
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double most_normal = *std::max_element(normal.begin(), normal.end());
    const double most_depth = *std::max_element(depth.begin(), depth.end());
    const double s_n = most_normal > 0.0 ? 1.0 - normal[i] / most_normal : 1.0;
    const double s_d = most_depth > 0.0 ? 1.0 - depth[i] / most_depth : 1.0;
    found[i].similarity = s_n * s_d;
  }
  std::stable_sort(found.begin(), found.end(), [](const SimilarGuide& a, const SimilarGuide& b) {
    if (a.similarity != b.similarity) return a.similarity > b.similarity;
    return a.distance2 < b.distance2;
  });
  return found;
}

/// reconstruct_light() over the whole image.
inline std::optional<glm::dvec3> reconstruct_light(const GuideMap& guides,
                                                   const Plane<std::uint8_t>& lit,
                                                   const EyePoint& eye, std::uint8_t eye_lit) {
  const Extent extent = guides.frame.extent();
  glm::dvec3 sum(0.0);
  double weights = 0.0;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const glm::dvec2 step = glm::dvec2(eye.pixel) - glm::dvec2(x + 0.5, y + 0.5);
      if (glm::length(step) > static_cast<double>(kReconstructRadius)) continue;
      if (!guides.is_surface(x, y) || !is_finite(guides.light(x, y))) continue;
      if (lit(x, y) != eye_lit) continue;
      const double dz = static_cast<double>(guides.depth(x, y)) - eye.depth;
      const double dn =
          1.0 -
          std::clamp(glm::dot(glm::dvec3(guides.normal(x, y)), glm::dvec3(eye.normal)), 0.0, 1.0);
      const double z = static_cast<double>(kSigmaZ) * dz, n = static_cast<double>(kSigmaN) * dn;
      const double weight = std::exp(-z * z - n * n);
      sum += weight * glm::dvec3(guides.light(x, y));
      weights += weight;
    }
  }
  if (weights < static_cast<double>(kLeastWeight)) return std::nullopt;
  return sum / weights;
}

}  // namespace eigenlight::reference
