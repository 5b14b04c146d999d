// Light from an equirectangular image around the scene.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/lights/distribution.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// Directions as Environment maps them. Choosing follows luminance * sin(theta) per texel.
class EnvironmentLight {
 public:
  /// Keeps a copy of what it needs. No environment: black.
  explicit EnvironmentLight(const std::optional<Environment>& environment);

  [[nodiscard]] bool is_black() const { return !(rows_.total() > 0.0); }
  /// Bilinear; wraps around the horizon, clamps at the poles. `direction` is unit.
  [[nodiscard]] glm::vec3 radiance(const glm::vec3& direction) const;
  /// Luminance of the radiance summed over all directions.
  [[nodiscard]] float power() const { return power_; }

  struct Sample {
    glm::vec3 direction{0.0f};
    float pdf = 0.0f;  ///< per steradian
  };
  /// Requires !is_black().
  [[nodiscard]] Sample sample(const glm::vec2& u) const;
  [[nodiscard]] float pdf(const glm::vec3& direction) const;

 private:
  [[nodiscard]] const glm::vec3& texel(int x, int y) const;
  [[nodiscard]] glm::vec2 to_pixel(const glm::vec3& direction) const;
  [[nodiscard]] float texel_pdf(float chance, float y) const;

  Extent extent_;
  std::vector<glm::vec3> texels_;
  Distribution rows_;
  std::vector<Distribution> columns_;  // per row
  float power_ = 0.0f;
};

}  // namespace eigenlight
