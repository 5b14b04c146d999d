// Light from an equirectangular image around the scene (environment map).
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/lights/distribution.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// Radiance and importance sampling of an Environment, which defines the mapping of directions.
/// Texels are sampled with probability proportional to luminance * sin(theta).
class EnvironmentLight {
 public:
  /// Copies the image. Without an environment the light is black.
  explicit EnvironmentLight(const std::optional<Environment>& environment);

  [[nodiscard]] bool is_black() const { return !(rows_.total() > 0.0); }
  /// Bilinear radiance from the unit vector `direction`. Wraps around the horizon and clamps at the
  /// poles.
  [[nodiscard]] glm::vec3 radiance(const glm::vec3& direction) const;
  /// Luminance integrated over all directions.
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
  [[nodiscard]] float texel_pdf(float probability, float y) const;

  Extent extent_;
  std::vector<glm::vec3> texels_;
  Distribution rows_;
  std::vector<Distribution> columns_;  // per row
  float power_ = 0.0f;
};

}  // namespace eigenlight
