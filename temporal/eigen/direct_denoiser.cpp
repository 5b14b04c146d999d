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

template <typename T>
void copy(const Plane<T>& from, Plane<T>& to) {
  ensure_extent(to, from.extent());
  to.copy_from(from);
}
template <std::size_t N>
void copy(const Planes<N>& from, Planes<N>& to) {
  for (std::size_t c = 0; c < N; ++c) copy(from[c], to[c]);
}

// What the loop reads of a frame, with `light` as its only light.
void copy_input(const FrameInput& from, const Planes<3>& light, Frame& to) {
  to.index = from.index;
  to.previous_index = from.previous_index;
  to.is_static = from.is_static;
  to.spp = from.spp;
  to.camera = from.camera;
  copy(from.surface.depth, to.surface.depth);
  copy(from.surface.normal, to.surface.normal);
  copy(from.surface.albedo, to.surface.albedo);
  copy(from.surface.id, to.surface.id);
  copy(from.motion, to.motion);
  copy(from.previous_depth, to.previous_depth);
  to.lights.resize(1);
  copy(light, to.lights[0].radiance);
}

}  // namespace

DirectDenoiser::DirectDenoiser(const DenoiserOptions& options)
    : loop_(one_layer(options), without_bound()), output_(make_planes<3>(options.extent)) {}

void DirectDenoiser::step(const FrameInput& frame, const Planes<3>& sun, const Planes<3>& soft) {
  const Extent extent = output_[0].extent();
  EL_CHECK(frame.extent() == extent && sun[0].extent() == extent && soft[0].extent() == extent,
           "direct light of frame {}: expected {}x{}", frame.index, extent.width, extent.height);
  copy_input(frame, soft, frame_);
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
