// A scene over time: camera path, and the perturbations that stress a temporal filter.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "render/scene.h"

namespace eigenlight {

/// What changes beside the camera. kAll is kLights and kObjects.
struct Perturbation {
  enum Kind { kNone, kLights, kObjects, kStep, kAll };
  static constexpr int kStepFrame = 24;  ///< a second after the start: history has settled

  // NOLINTNEXTLINE(google-explicit-constructor): a kind alone is a perturbation.
  Perturbation(Kind k) : kind(k) {}
  Kind kind;
  int step_frame = kStepFrame;  ///< of kStep: the first frame under the new light, >= 1
};

/// `none`, `lights`, `objects`, `all`, `step` or `step:FRAME`. Throws std::invalid_argument listing
/// these, or on a frame below 1 or above a million.
[[nodiscard]] Perturbation parse_perturbation(std::string_view text);
/// The same in words that parse_perturbation reads; the frame of a step is always there.
[[nodiscard]] std::string format_perturbation(const Perturbation& perturbation);

/// Under this name image files carry format_perturbation().
inline constexpr const char* kPerturbAttribute = "eigenlight.perturb";

inline constexpr float kFramesPerSecond = 24.0f;

/// The flythrough of a scene: Catmull-Rom through the camera keys at kFramesPerSecond, there and
/// back again for ever, so that every frame number has a view. Adds the objects of
/// Perturbation::kObjects to `scene` (meshes, materials, instances), whose paths are found by probe
/// rays along the camera path. Lights: perturb_lights.h. Everything is a function of the frame
/// number alone. Throws std::invalid_argument on a scene without camera keys or triangles.
[[nodiscard]] std::unique_ptr<Animation> make_flythrough(Scene& scene, Perturbation perturbation,
                                                         Extent extent);

}  // namespace eigenlight
