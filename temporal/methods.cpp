#include <algorithm>
#include <string>

#include "temporal/baselines/chen2012.h"
#include "temporal/baselines/running_mean.h"
#include "temporal/denoiser.h"
#include "temporal/eigen_denoiser.h"
#include "temporal/pass_through.h"

namespace eigenlight {
namespace {

template <typename Kind>
std::unique_ptr<Denoiser> make(const DenoiserOptions& options) {
  return std::make_unique<Kind>(options);
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> kMethods{
      {"eigenlight",
       "tiled incremental PCA, leave-one-out coefficients, innovation test, resampling",
       "after Chen 2012", make<EigenDenoiser>},
      {"chen2012", "incremental PCA of whole images, basis filtering, 120 samples at new pixels",
       "Chen, Lei and Chang 2012", make<Chen2012>},
      {"mean", "reprojected running mean of up to 32 frames", "", make<RunningMean>},
      {"noisy", "the frames as they are rendered", "", make<PassThrough>},
  };
  return kMethods;
}

std::unique_ptr<Denoiser> make_denoiser(std::string_view name, const DenoiserOptions& options) {
  check_extent(options.extent);
  EL_CHECK(options.bases >= 1 && options.bases <= 8, "bases {}: expected 1 to 8", options.bases);
  const auto method = std::find_if(methods().begin(), methods().end(),
                                   [&](const Method& m) { return m.name == name; });
  if (method == methods().end()) {
    std::string known;
    for (const Method& m : methods())
      known += fmt::format("{}{}", known.empty() ? "" : ", ", m.name);
    throw std::invalid_argument(fmt::format("unknown method '{}'; known: {}", name, known));
  }
  return method->make(options);
}

}  // namespace eigenlight
