// Which perturbation a sequence has, in words and in the attributes of its files.
#pragma once

#include <string>
#include <string_view>

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

}  // namespace eigenlight
