#include "spatial/rivals/tap_planes.h"

#include <algorithm>
#include <cmath>

#include "frame/usable_surface.h"

namespace eigenlight {
namespace {

constexpr int kLanes = 16;  // of the widest vector

int round_up(int reach) { return (reach + kLanes - 1) / kLanes * kLanes; }

bool has(const Planes<3>& planes, Extent extent) {
  return std::all_of(planes.begin(), planes.end(),
                     [&](const Plane<float>& plane) { return plane.extent() == extent; });
}

glm::vec3 value(const Planes<3>& planes, int x, int y) {
  return {planes[0](x, y), planes[1](x, y), planes[2](x, y)};
}

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

void check_spatial(const SpatialInputs& in, const Planes<3>& out, Extent extent, const char* what) {
  EL_CHECK(in.guides.extent() == extent && has(in.guides.surface.normal, extent) &&
               has(in.guides.surface.albedo, extent) && has(in.signal, extent) &&
               in.weight.extent() == extent && has(out, extent),
           "{} made for {}x{}: got planes of another size", what, extent.width, extent.height);
  EL_CHECK(&in.signal != &out, "{}: the output must not be the signal itself", what);
}

TapPlanes::TapPlanes(Extent extent, int reach)
    : extent_(extent), margin_(round_up(reach)), grid_(stage_tiles(extent)) {
  light = make_light();
  depth = light.weight.clone();
  surface = light.weight.clone();
  for (auto* planes : {&normal, &position, &albedo}) {
    *planes = make_planes<3>(surface.extent());
  }
}

TapLight TapPlanes::make_light() const {
  const Extent padded{extent_.width + 2 * margin_ + kLanes, extent_.height};
  return {make_planes<3>(padded), Plane<float>(padded)};
}

void TapPlanes::load(const SpatialInputs& in) {
  for_each_tile(grid_, [&](const Rect& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) load_pixel(in, x, y);
    }
  });
}

void TapPlanes::load_pixel(const SpatialInputs& in, int x, int y) {
  const GBuffer& from = in.guides.surface;
  const Camera& camera = in.guides.camera;
  const glm::vec3 n = value(from.normal, x, y), a = value(from.albedo, x, y);
  const glm::vec3 s = value(in.signal, x, y);
  const float z = from.depth(x, y), w = in.weight(x, y);
  const bool shown = is_usable_surface(from, x, y) && is_finite(a);
  const bool used = shown && std::isgreater(w, 0.0f) && std::isfinite(w) && is_finite(s);
  const glm::vec2 pixel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const int i = x + margin_;
  depth(i, y) = shown ? z : 0.0f;
  const glm::vec3 at =
      glm::transpose(camera.world_to_view) * (camera.pixel_to_view(pixel) * depth(i, y));
  surface(i, y) = shown ? 1.0f : 0.0f;
  light.weight(i, y) = used ? w : 0.0f;
  for (int c = 0; c < 3; ++c) {
    normal[c](i, y) = shown ? n[c] : 0.0f;
    albedo[c](i, y) = shown ? a[c] : 0.0f;
    position[c](i, y) = at[c];
    light.color[c](i, y) = used ? s[c] : 0.0f;
  }
}

}  // namespace eigenlight
