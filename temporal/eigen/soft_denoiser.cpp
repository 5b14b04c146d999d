#include "temporal/eigen/soft_denoiser.h"

#include "temporal/stage_clock.h"

namespace eigenlight {

namespace {

DenoiserOptions with_one_basis(DenoiserOptions options) {
  options.bases = 1;
  return options;
}

}  // namespace

SoftOptions::SoftOptions() {
  eigen.even_gain = true;
  eigen.filter = false;
  eigen.look_back = false;
  eigen.young_age = 0.0f;
  // As good as no bound: what it takes from outliers is missing in the picture, and means over 3 x
  // 3 pixels let the filter spread them.
  eigen.fireflies.deviations = 1000.0f;
  eigen.fireflies.times = 1000.0f;
}

SoftDenoiser::SoftDenoiser(const DenoiserOptions& options, const SoftOptions& tuning)
    : options_(tuning),
      eigen_(with_one_basis(options), tuning.eigen),
      filter_(options.extent, tuning.filter) {
  for (int i = 0; i < options.layers; ++i) {
    outputs_.push_back(make_planes<3>(options.extent));
    variances_.emplace_back(options.extent);
  }
}

const Planes<3>* SoftDenoiser::step(FrameSource& source) {
  if (!eigen_.step(source)) return nullptr;
  report_ = eigen_.report();
  StageClock clock;
  const Frame& frame = eigen_.frame();
  std::vector<SoftLayer> layers;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const NoisyLight& light = frame.lights[i];
    if (light.is_direct) {
      copy_planes(light.radiance, outputs_[i]);
      variance_of_frame(frame, light.radiance, variances_[i]);
    } else {
      copy_planes(eigen_.output(static_cast<int>(i)), outputs_[i]);
      variances_[i].copy_from(eigen_.variance(static_cast<int>(i)));
    }
    layers.push_back(
        {&outputs_[i], &variances_[i], light.is_direct ? options_.direct_sigmas : options_.sigmas});
  }
  filter_.process(frame, frame.mean_normal, layers);
  report_[Stage::kFilter] += clock.lap();
  return &outputs_.front();
}

}  // namespace eigenlight
