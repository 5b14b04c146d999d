// Light that changes: Perturbation::kLights moves and pulses, Perturbation::kStep jumps.
#pragma once

#include "render/scene/scene.h"

namespace eigenlight {

inline constexpr int kLightPeriod = 18;      ///< frames
inline constexpr float kLightSweep = 20.0f;  ///< degrees to each side
inline constexpr float kLightPulse = 0.6f;   ///< of the strength, up and down
/// Factor of the step, to taste: a curtain drawn open. Large against the noise of an image's mean.
inline constexpr float kLightStep = 3.0f;

/// What is perturbed in a scene: all suns; without one the rect, the sphere or the emissive
/// triangles (all of them together) of greatest power; without these, sky and environment.
struct MainLight {
  enum class Kind { kSuns, kRect, kSphere, kEmissive, kSky };
  Kind kind = Kind::kSky;
  std::size_t index = 0;  ///< of the rect or sphere
};
[[nodiscard]] MainLight main_light(const Scene& scene);

/// The lights of a scene over frames. All suns sweep kLightSweep to both sides of their place
/// against the horizon (one that stands lower than 25 degrees sweeps around 25, to stay above it)
/// and their irradiance pulses by kLightPulse, a quarter of a period ahead of the sweep. Other main
/// lights are treated so: a rect tilts about half_u, a sphere swings like a pendulum three radii
/// long, emissive triangles get a lobe that swings about the downward axis, sky and environment
/// only pulse.
class LightPerturbation {
 public:
  /// Keeps what it needs of `scene`.
  explicit LightPerturbation(const Scene& scene);

  /// Repeats after kLightPeriod frames, which may be negative.
  [[nodiscard]] Lights at(int frame) const;

 private:
  Lights rest_;
  MainLight main_;
  glm::vec3 up_;
};

/// The lights of a scene whose main light shines kLightStep times as bright from one frame on.
class LightStep {
 public:
  LightStep(const Scene& scene, int frame);

  [[nodiscard]] const Lights& at(int frame) const { return frame < frame_ ? before_ : after_; }

 private:
  Lights before_, after_;
  int frame_;
};

}  // namespace eigenlight
