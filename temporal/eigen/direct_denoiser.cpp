#include "temporal/eigen/direct_denoiser.h"

#include <stdexcept>

#include "frame/check.h"
#include "frame/memory_source.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

DenoiserOptions one_layer(DenoiserOptions options) {
  options.layers = 1;
  options.bases = 1;
  options.without.clear();
  return options;
}

EigenOptions without_bound() {
  EigenOptions options;
  options.fireflies.deviations = 1000.0f;
  options.fireflies.times = 1000.0f;
  options.even_gain = true;
  return options;
}

}  // namespace

DirectDenoiser::DirectDenoiser(const DenoiserOptions& options)
    : loop_(one_layer(options), without_bound()), output_(make_planes<3>(options.extent)) {}

void DirectDenoiser::step(const FrameInput& frame, const Planes<3>& sun, const Planes<3>& soft) {
  const Extent extent = output_[0].extent();
  EL_CHECK(frame.extent() == extent && sun[0].extent() == extent && soft[0].extent() == extent,
           "direct light of frame {}: expected {}x{}", frame.index, extent.width, extent.height);
  copy_all_but_lights(frame, frame_);
  frame_.lights.resize(1);
  ensure_extent(frame_.lights[0].radiance, extent);
  copy_planes(soft, frame_.lights[0].radiance);
  OneFrameSource source(frame_);
  const Planes<3>* denoised = loop_.step(source);
  if (denoised == nullptr) throw std::logic_error("the loop did not take a frame");
  parallel_for(extent.height, [&](int y) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float *hard = sun[c].row(y), *smooth = (*denoised)[c].row(y);
      float* out = output_[c].row(y);
      for (int x = 0; x < extent.width; ++x) out[x] = hard[x] + smooth[x];
    }
  });
}

}  // namespace eigenlight
