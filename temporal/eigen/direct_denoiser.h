// Direct light of a renderer that knows what of it comes from suns.
#pragma once

#include "temporal/eigen/eigen_denoiser.h"

namespace eigenlight {

/// Denoises direct light in two parts, and gives their sum.
///
/// Light of sky and local lights is as soft and as noisy as indirect light: it goes through a loop
/// of its own (EigenDenoiser), without further samples, with one basis whose gain is a ratio of
/// sums of light (even_sums.h), and without a bound of fireflies: of a narrow sky that few rays
/// meet both would take light. Light of suns has edges that move over surfaces and are in no guide,
/// and noise nowhere but there: the renderer draws more samples in penumbras, and the light stays
/// as it is sampled. Any filter of it blurred edges more than it smoothed them
/// (docs/experiments/2026-12-direct-light.md).
class DirectDenoiser {
 public:
  /// Takes the size of `options`. Throws std::invalid_argument on a bad one.
  explicit DirectDenoiser(const DenoiserOptions& options);

  /// Denoises the direct light of the next frame, radiance over albedo. Light of suns that is not
  /// finite stays so. Throws std::invalid_argument if a size differs.
  void step(const FrameInput& frame, const Planes<3>& sun, const Planes<3>& soft);

  /// Of the last step(): radiance over albedo, 0 without surface.
  [[nodiscard]] const Planes<3>& output() const { return output_; }  ///< sun + soft()
  [[nodiscard]] const Planes<3>& soft() const { return loop_.output(0); }

  /// The state between two frames, as Denoiser has it.
  void save(StateWriter& out) const { loop_.save(out); }
  void load(StateReader& in) { loop_.load(in); }

 private:
  EigenDenoiser loop_;
  Frame frame_;  // with soft light as its only light
  Planes<3> output_;
};

}  // namespace eigenlight
