// Changing light: under Perturbation::kLights it moves and pulses, under kStep it jumps.
#pragma once

#include "render/scene/scene.h"

namespace eigenlight {

inline constexpr int kLightPeriod = 18;      ///< frames
inline constexpr float kLightSweep = 20.0f;  ///< degrees to each side
inline constexpr float kLightPulse = 0.6f;   ///< of the strength, up and down
/// Factor of the step, by taste: a curtain drawn open. Large against the noise of an image's mean.
inline constexpr float kLightStep = 3.0f;

/// The light that is perturbed: all suns; without suns the rect, the sphere or all emissive
/// triangles together, whichever has the greatest power; without these, sky and environment.
struct MainLight {
  enum class Kind { kSuns, kRect, kSphere, kEmissive, kSky };
  Kind kind = Kind::kSky;
  std::size_t index = 0;  ///< of the rect or sphere
};
[[nodiscard]] MainLight main_light(const Scene& scene);

/// The lights of a scene over frames. Suns sweep up and down by kLightSweep (a sun below 25 degrees
/// sweeps around 25 degrees, to stay above the horizon), and their irradiance pulses by
/// kLightPulse, a quarter of a period ahead of the sweep. Other main lights pulse as well: a rect
/// tilts about half_u, a sphere swings like a pendulum three radii long, emissive triangles get a
/// lobe that swings about the downward axis, sky and environment only pulse.
class LightPerturbation {
 public:
  /// Copies the lights of `scene`.
  explicit LightPerturbation(const Scene& scene);

  /// Repeats after kLightPeriod frames; `frame` may be negative.
  [[nodiscard]] Lights at(int frame) const;

 private:
  Lights rest_;
  MainLight main_;
  glm::vec3 up_;
};

/// The lights of a scene whose main light is kLightStep times as bright from `frame` on.
class LightStep {
 public:
  LightStep(const Scene& scene, int frame);

  [[nodiscard]] const Lights& at(int frame) const { return frame < frame_ ? before_ : after_; }

 private:
  Lights before_, after_;
  int frame_;
};

}  // namespace eigenlight
