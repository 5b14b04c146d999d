// Light that moves and pulses: Perturbation::kLights.
#pragma once

#include "render/scene.h"

namespace eigenlight {

inline constexpr int kLightPeriod = 18;      ///< frames
inline constexpr float kLightSweep = 20.0f;  ///< degrees to each side
inline constexpr float kLightPulse = 0.6f;   ///< of the strength, up and down

/// The lights of a scene over frames. All suns sweep kLightSweep to both sides of their place
/// against the horizon (one that stands lower than 25 degrees sweeps around 25, to stay above it)
/// and their irradiance pulses by kLightPulse, a quarter of a period ahead of the sweep. A scene
/// without a sun has its strongest light treated so: a rect tilts about half_u, a sphere swings
/// like a pendulum three radii long, emissive triangles get a lobe that swings about the downward
/// axis. Sky or environment, where there is nothing else, only pulse.
class LightPerturbation {
 public:
  /// Keeps what it needs of `scene`.
  explicit LightPerturbation(const Scene& scene);

  /// Repeats after kLightPeriod frames, which may be negative.
  [[nodiscard]] Lights at(int frame) const;

 private:
  enum class Target { kSuns, kRect, kSphere, kEmissive, kSky };

  Lights rest_;
  glm::vec3 up_;
  Target target_ = Target::kSky;
  std::size_t index_ = 0;  ///< of the rect or sphere
};

}  // namespace eigenlight
