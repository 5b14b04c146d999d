// How long a sequence takes to follow a step in light.
#pragma once

#include <map>
#include <optional>
#include <vector>

namespace eigenlight {

/// One measured frame: means over surface pixels and channels of the test and of the reference, and
/// the test's relMSE.
struct LightLevel {
  int frame = 0;
  double test = 0.0, reference = 0.0, relmse = 0.0;
};

/// Share of a step that counts as followed.
inline constexpr double kStepReached = 0.9;
/// The least change of the reference's mean, as a share of the larger one, that counts as a step. A
/// flying camera alone changes it by up to 0.03 a frame (README.md).
inline constexpr double kLeastStep = 0.1;

/// With f = r_s / r_(s-1), the factor of the light step at frame s in the mean of the reference,
/// and q_t = (x_t / r_t) / (x_(s-1) / r_(s-1)), the share of the step that the test shows is
///   reached(t) = (q_t - 1 / f) / (1 - 1 / f):
/// 0 for the light as it was, 1 for the light as it is. Ratios to the reference take out what a
/// moving camera changes, those to the frame before the step a method's own bias. After a light
/// that was off (r_(s-1) = 0) q_t is x_t / r_t.
struct Lag {
  /// Frame of the step to the first frame that has reached 0.9; 0: at once. Absent if none has, or
  /// if a frame on the way there was not measured.
  std::optional<int> frames;
  /// Sum of relMSE over the frames from the step to that one, both included; absent with `frames`.
  std::optional<double> error;
  /// By frame, from the step on; without frames whose reference is black, and empty if the test was
  /// black before the step.
  std::map<int, double> reached;
};

/// Lag behind the step between frames `step` - 1 and `step`; `levels` may have any order. Absent
/// unless both of these frames are among them, the reference changes by kLeastStep between the two,
/// and it is not black after it: a light that goes out leaves nothing to compare with.
[[nodiscard]] std::optional<Lag> measure_lag(std::vector<LightLevel> levels, int step);

}  // namespace eigenlight
