// The perturbation of a sequence, as text and as an attribute of its files.
#pragma once

#include <string>
#include <string_view>

namespace eigenlight {

/// What changes in addition to the camera. kAll is kLights and kObjects.
struct Perturbation {
  enum Kind { kNone, kLights, kObjects, kStep, kAll };
  static constexpr int kStepFrame = 24;  ///< one second: history has settled by then

  // NOLINTNEXTLINE(google-explicit-constructor): a kind alone is a perturbation.
  Perturbation(Kind k) : kind(k) {}
  Kind kind;
  int step_frame = kStepFrame;  ///< for kStep: the first frame in the new light, >= 1
};

/// `none`, `lights`, `objects`, `all`, `step` or `step:FRAME`. Throws std::invalid_argument listing
/// these, or on a frame below 1 or above a million.
[[nodiscard]] Perturbation parse_perturbation(std::string_view text);
/// Text that parse_perturbation() reads; a step always has its frame.
[[nodiscard]] std::string format_perturbation(const Perturbation& perturbation);

/// The attribute of image files that holds format_perturbation().
inline constexpr const char* kPerturbAttribute = "eigenlight.perturb";

}  // namespace eigenlight
