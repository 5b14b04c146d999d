#include "frame/frame.h"

namespace eigenlight {
namespace {

template <typename T>
void copy_plane(const Plane<T>& from, Plane<T>& to) {
  if (from.empty()) {
    to = {};
    return;
  }
  ensure_extent(to, from.extent(), from.channels());
  to.copy_from(from);
}

template <std::size_t N>
void copy_plane(const Planes<N>& from, Planes<N>& to) {
  for (std::size_t c = 0; c < N; ++c) copy_plane(from[c], to[c]);
}

}  // namespace

void copy_all_but_lights(const FrameInput& from, FrameInput& to) {
  // Names every member, so that one that is added later cannot be forgotten here.
  const auto& [number, previous, still, samples, camera, surface, lights, motion, previous_depth,
               mean_normal, rays, non_finite] = from;
  const auto& [depth, normal, albedo, id] = surface;
  to.index = number;
  to.previous_index = previous;
  to.is_static = still;
  to.spp = samples;
  to.camera = camera;
  copy_plane(depth, to.surface.depth);
  copy_plane(normal, to.surface.normal);
  copy_plane(albedo, to.surface.albedo);
  copy_plane(id, to.surface.id);
  copy_plane(motion, to.motion);
  copy_plane(previous_depth, to.previous_depth);
  copy_plane(mean_normal, to.mean_normal);
  to.rays = rays;
  to.non_finite_samples = non_finite;
}

void copy_frame(const Frame& from, Frame& to) {
  copy_all_but_lights(from, to);
  to.lights.resize(from.lights.size());
  for (std::size_t i = 0; i < from.lights.size(); ++i) {
    const auto& [radiance, color, is_direct, is_glossy] = from.lights[i];
    copy_plane(radiance, to.lights[i].radiance);
    copy_plane(color, to.lights[i].color);
    to.lights[i].is_direct = is_direct;
    to.lights[i].is_glossy = is_glossy;
  }
  copy_plane(from.direct, to.direct);
  copy_plane(from.emission, to.emission);
  copy_plane(from.position, to.position);
}

}  // namespace eigenlight
