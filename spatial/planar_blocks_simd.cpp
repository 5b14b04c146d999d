#include <algorithm>
#include <cmath>

#include "frame/float_traps.h"
#include "frame/usable_surface.h"
#include "spatial/planar_blocks_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/planar_blocks_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
// No wider than a block.
using F = hn::CappedTag<float, PlanarBlocks::kSide>;
using VF = hn::Vec<F>;

// The plane of pixel (x, y).
PlanarBlocks::Block PlaneOf(const FrameInput& guides, int x, int y) {
  PlanarBlocks::Block block;
  const auto& normal = guides.surface.normal;
  block.depth = guides.surface.depth(x, y);
  block.normal = {normal[0](x, y), normal[1](x, y), normal[2](x, y)};
  block.is_planar = is_usable_surface(guides.surface, x, y);
  if (!block.is_planar) return block;
  const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const glm::mat3 to_world = glm::transpose(guides.camera.world_to_view);
  block.point = to_world * (block.depth * guides.camera.pixel_to_view(center));
  block.distance = glm::dot(block.normal, block.point);
  return block;
}

// Whether all pixels of `area` lie in the plane. Products and sums are rounded one by one, so that
// every instruction set comes to the same answer.
bool HoldsAll(const FrameInput& guides, float tolerance, const Rect& area,
              const PlanarBlocks::Block& block) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const Camera& camera = guides.camera;
  const glm::vec3 view = camera.world_to_view * block.normal;
  const float plane_x = view.x / camera.focal, plane_y = view.y / camera.focal;
  const VF most = hn::Set(d, tolerance * block.depth);
  auto good = hn::FirstN(d, hn::Lanes(d));
  for (int y = area.y0; y < area.y1; ++y) {
    const auto load = [&](const Plane<float>& plane, int x) {
      return hn::LoadU(d, plane.row(y) + x);
    };
    // N . ray(x, y) = plane_x x + row
    const float row = view.z + plane_y * (static_cast<float>(y) + 0.5f - camera.center.y) +
                      plane_x * (0.5f - camera.center.x);
    for (int x = area.x0; x < area.x1; x += static_cast<int>(hn::Lanes(d))) {
      const VF along = hn::Add(hn::Mul(hn::Set(d, plane_x), hn::Iota(d, static_cast<float>(x))),
                               hn::Set(d, row));
      const VF off = hn::Abs(
          hn::Sub(hn::Mul(load(guides.surface.depth, x), along), hn::Set(d, block.distance)));
      VF cosine = hn::Zero(d);
      for (std::size_t c = 0; c < 3; ++c) {
        const VF own = hn::Set(d, block.normal[static_cast<int>(c)]);
        cosine = hn::Add(cosine, hn::Mul(own, load(guides.surface.normal[c], x)));
      }
      const VF turn = hn::Abs(hn::Sub(cosine, hn::Set(d, 1.0f)));
      const auto id = hn::LoadU(du, guides.surface.id.row(y) + x);
      const auto here = hn::And(hn::And(hn::Le(off, most), hn::Le(turn, hn::Set(d, kPlanarTurn))),
                                hn::RebindMask(d, hn::Ne(id, hn::Zero(du))));
      // Lanes beyond the image hold nothing.
      const auto beyond =
          hn::Ge(hn::Iota(d, static_cast<float>(x)), hn::Set(d, static_cast<float>(area.x1)));
      good = hn::And(good, hn::Or(here, beyond));
    }
    if (!hn::AllTrue(d, good)) return false;
  }
  return true;
}

void FindPlanes(const FrameInput& guides, float tolerance, const Rect& area,
                PlanarBlocks::Block* blocks) {
  for (int x = area.x0; x < area.x1; x += PlanarBlocks::kSide) {
    const Rect block{x, area.y0, std::min(x + PlanarBlocks::kSide, area.x1), area.y1};
    PlanarBlocks::Block& out = *blocks++;
    out = PlaneOf(guides, x, area.y0);
    out.is_planar = out.is_planar && HoldsAll(guides, tolerance, block, out);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(FindPlanes);

void find_planes(const FrameInput& guides, float tolerance, const Rect& area,
                 PlanarBlocks::Block* blocks) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(FindPlanes)(guides, tolerance, area, blocks);
}

}  // namespace eigenlight
#endif
