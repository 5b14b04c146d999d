#include <algorithm>

#include "spatial/planar_blocks_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/planar_blocks_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

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

// Where a vector of pixels lies in the plane of a block. `along`: N . ray. Products and sums are
// rounded one by one, so that every instruction set gives the same answer.
MF8 LiesInPlane(const FrameInput& guides, const PlanarBlocks::Block& block, VF8 along,
                VF8 tolerance, int x, int y) {
  const F8 d;
  const GBuffer& surface = guides.surface;
  const VF8 off = Abs(Sub(Mul(Load(surface.depth, x, y, d), along), Set(d, block.distance)));
  VF8 cosine = Zero(d);
  for (int c = 0; c < 3; ++c) {
    cosine = Add(cosine, Mul(Set(d, block.normal[c]), Load(surface.normal[c], x, y, d)));
  }
  const VF8 turn = Abs(Sub(cosine, Set(d, 1.0f)));
  return And(HasSurface(surface.id, x, y, d),
             And(Le(off, tolerance), Le(turn, Set(d, kPlanarTurn))));
}

// Whether all pixels of `area` lie in the plane of the block.
bool HoldsAll(const FrameInput& guides, float tolerance, const Rect& area,
              const PlanarBlocks::Block& block) {
  const F8 d;
  const Camera& camera = guides.camera;
  const glm::vec3 view = camera.world_to_view * block.normal;
  const float plane_x = view.x / camera.focal, plane_y = view.y / camera.focal;
  const VF8 most = Set(d, tolerance * block.depth);
  MF8 good = FirstLanes(LaneCount(d), d);
  for (int y = area.y0; y < area.y1; ++y) {
    // N . ray(x, y) = plane_x x + row
    const float row = view.z + plane_y * (static_cast<float>(y) + 0.5f - camera.center.y) +
                      plane_x * (0.5f - camera.center.x);
    for (int x = area.x0; x < area.x1; x += LaneCount(d)) {
      const VF8 column = Iota(d, static_cast<float>(x));
      const VF8 along = Add(Mul(Set(d, plane_x), column), Set(d, row));
      const MF8 beyond = Not(FirstLanes(area.x1 - x, d));
      good = And(good, Or(LiesInPlane(guides, block, along, most, x, y), beyond));
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
