#include "temporal/methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "frame/named.h"
#include "spatial/rivals/atrous_filter.h"
#include "spatial/rivals/cross_bilateral.h"
#include "spatial/rivals/guided_spatial.h"
#include "spatial/rivals/pyramid_filter.h"
#include "temporal/baselines/bmfr.h"
#include "temporal/baselines/chen2012.h"
#include "temporal/baselines/frame_by_frame.h"
#include "temporal/baselines/hems2010.h"
#include "temporal/baselines/meyer2006.h"
#include "temporal/baselines/running_mean.h"
#include "temporal/baselines/svgf.h"
#include "temporal/eigen/eigen_parts.h"

namespace eigenlight {
namespace {

template <typename Kind>
std::unique_ptr<Denoiser> make(const DenoiserOptions& options) {
  return std::make_unique<Kind>(options);
}

std::unique_ptr<Denoiser> by_frame(const DenoiserOptions& options, std::string_view name,
                                   std::unique_ptr<SpatialFilter> filter) {
  return std::make_unique<FrameByFrame>(options, name, std::move(filter));
}

template <typename Filter, typename Options>
std::unique_ptr<Denoiser> through(const DenoiserOptions& options, std::string_view name,
                                  const Options& chosen) {
  return by_frame(options, name, std::make_unique<Filter>(options.extent, chosen));
}

void check_parts(const Method& method, const std::vector<std::string>& without) {
  for (const std::string& name : without) {
    const bool known = std::any_of(method.parts.begin(), method.parts.end(),
                                   [&](const Part& part) { return part.name == name; });
    EL_CHECK(known, "method '{}' has no part '{}' to turn off; it has: {}", method.name, name,
             names_of(method.parts));
  }
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> kMethods{
      {"eigenlight",
       "tiled incremental PCA, leave-one-out coefficients, innovation test, resampling",
       "after Chen 2012", make_eigen_denoiser, eigen_parts()},
      {"chen2012", "incremental PCA of whole images, basis filtering, 120 samples at new pixels",
       "Chen, Lei and Chang 2012", make<Chen2012>},
      {"svgf", "temporal accumulation, five a-trous passes steered by variance, the first fed back",
       "Schied et al. 2017", make<Svgf>},
      {"bmfr", "blockwise regression on normals and positions, between two temporal accumulations",
       "Koskela et al. 2019", make<Bmfr>},
      {"hems2010", "weighted sum of 16 reprojected frames, similar colors weigh more",
       "Herzog, Eisemann, Myszkowski and Seidel 2010", make<Hems2010>},
      {"meyer2006", "offline: PCA of the whole sequence, read ahead and held in memory",
       "Meyer and Anderson 2006", make<Meyer2006>},
      {"mean", "reprojected running mean of up to 32 frames", "", make<RunningMean>},
      {"guided", "each frame through the guided filter: normals and depth", "Bauszat et al. 2011",
       [](const DenoiserOptions& options) {
         return through<GuidedSpatial>(options, "guided", guided_alone());
       }},
      {"atrous", "each frame through edge-avoiding wavelets: color, normals, positions",
       "Dammertz et al. 2010",
       [](const DenoiserOptions& options) {
         return through<AtrousFilter>(options, "atrous", AtrousFilterOptions{});
       }},
      {"cross-bilateral", "each frame through a cross bilateral filter: normals, depth, albedo",
       "Eisemann and Durand 2004; Petschnigg et al. 2004",
       [](const DenoiserOptions& options) {
         return through<CrossBilateral>(options, "cross-bilateral", CrossBilateralOptions{});
       }},
      {"pyramid", "each frame alone: bilateral filtering out of a pyramid, with trained weights",
       "Xu et al. 2024",
       [](const DenoiserOptions& options) {
         return through<PyramidFilter>(options, "pyramid", GlobalIlluminationEdge{});
       }},
      {"noisy", "the frames as they are rendered", "",
       [](const DenoiserOptions& options) { return by_frame(options, "noisy", nullptr); }},
  };
  return kMethods;
}

std::unique_ptr<Denoiser> make_denoiser(std::string_view name, const DenoiserOptions& options) {
  check_extent(options.extent);
  EL_CHECK(options.bases >= 1 && options.bases <= 8, "bases {}: expected 1 to 8", options.bases);
  const Method& method = find_named(methods(), name, "method");
  check_parts(method, options.without);
  return method.make(options);
}

}  // namespace eigenlight
