#include "temporal/change/edges.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/edges_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/surface-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

constexpr float kBlends = 1e-3f;  // pixels off whole ones

VF OffWhole(VF motion) { return Abs(Sub(motion, hn::Round(motion))); }

// A vector of pixels, and how far off its own surface a neighbor's may be.
struct Query {
  Surface own;
  TangentPlanes planes;
  VF tolerance;  // of the plane
  VF cosine;
};

Query LoadQuery(const FrameInput& frame, const TapOptions& options, int x, int y) {
  const Surface own = LoadSurface(frame.surface, x, y);
  return {own, TangentPlanes(frame.camera, own.normal, own.depth, x, y),
          Mul(own.depth, Set(options.plane_distance)), Set(options.normal_cosine)};
}

// Where the neighbors from column x of row y on show the same surface.
MF IsSame(const Query& q, const GBuffer& surface, int x, int y) {
  const Surface neighbor = LoadSurface(surface, x, y);
  const VF along = q.planes.Along(Iota(x), Set(y));
  const VF off = Abs(MulSub(along, neighbor.depth, q.planes.distance));
  const VF cosine = DotInOrder(q.own.normal, neighbor.normal);
  return And(RebindMask(F(), Eq(neighbor.id, q.own.id)),
             And(Le(off, q.tolerance), Ge(cosine, q.cosine)));
}

// IsSame() of the neighbors to the left (step -1) or right (1). Beside the image it is true.
MF IsSameBeside(const Query& q, const GBuffer& surface, int x, int y, int step) {
  const VF column = Iota(x + step);
  const MF outside = Or(Lt(column, Zero()), Ge(column, Set(surface.depth.width())));
  return Or(outside, IsSame(q, surface, x + step, y));
}

// Where all neighbors show the pixel's own surface.
MF IsInside(const FrameInput& frame, const TapOptions& options, int x, int y) {
  const GBuffer& surface = frame.surface;
  const Query q = LoadQuery(frame, options, x, y);
  MF same = And(IsSameBeside(q, surface, x, y, -1), IsSameBeside(q, surface, x, y, 1));
  if (y > 0) same = And(same, IsSame(q, surface, x, y - 1));
  if (y + 1 < frame.extent().height) same = And(same, IsSame(q, surface, x, y + 1));
  return same;
}

void FindEdges(const FrameInput& frame, const TapOptions& options, const Rect& tile,
               Plane<std::uint8_t>& edge) {
  ForEachVector(tile, [&](int x, int y) {
    prefetch_below(frame.surface.depth, x, y);
    const VF blend =
        Add(OffWhole(Load(frame.motion[0], x, y)), OffWhole(Load(frame.motion[1], x, y)));
    MF found = And(HasSurface(frame.surface.id, x, y), Gt(blend, Set(kBlends)));
    if (!AllFalse(F(), found)) found = AndNot(IsInside(frame, options, x, y), found);
    StoreFlags(found, edge, x, y);
  });
}

void ShortenAges(const Plane<std::uint8_t>& edge, const Plane<float>& samples,
                 const LongestAges& longest, const Rect& tile, Plane<float>& age) {
  const VF inside = Set(longest.inside), at_edges = Set(longest.at_edges);
  ForEachVector(tile, [&](int x, int y) {
    prefetch_below(edge, x, y);
    const MF is_edge = RebindMask(F(), Ne(LoadBytes(edge, x, y), Zero(I())));
    const VF most = Max(IfThenElse(is_edge, at_edges, inside), Load(samples, x, y));
    Store(Min(Load(age, x, y), most), age, x, y);
  });
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(FindEdges);
HWY_EXPORT(ShortenAges);

void find_edges(const FrameInput& frame, const TapOptions& options, const Rect& tile,
                Plane<std::uint8_t>& edge) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(FindEdges)(frame, options, tile, edge);
}

void shorten_ages(const Plane<std::uint8_t>& edge, const Plane<float>& samples,
                  const LongestAges& longest, const Rect& tile, Plane<float>& age) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(ShortenAges)(edge, samples, longest, tile, age);
}

}  // namespace eigenlight
#endif
