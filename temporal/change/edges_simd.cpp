#include <algorithm>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "temporal/change/edges.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/edges_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using MF = hn::Mask<F>;

constexpr float kBlends = 1e-3f;  // pixels off whole ones

VF OffWhole(VF motion) { return hn::Abs(hn::Sub(motion, hn::Round(motion))); }

// The surfaces of a vector of pixels, from column x of row y on.
struct Seen {
  VF normal[3], depth;
  VI id;
};

Seen Load(const GBuffer& surface, int x, int y) {
  const F d;
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  return {{load(surface.normal[0]), load(surface.normal[1]), load(surface.normal[2])},
          load(surface.depth),
          hn::LoadU(I(), reinterpret_cast<const std::int32_t*>(surface.id.row(y)) + x)};
}

// What pixels ask of their neighbors.
struct Wanted {
  Seen own;
  VF x, y, c;              // N . ray(column, line) = x column + y line + c
  VF distance, tolerance;  // N . X; of the plane
  VF cosine;
};

Wanted Ask(const FrameInput& frame, const TapOptions& options, const Seen& own, int x, int y) {
  const F d;
  const Camera& camera = frame.camera;
  const glm::mat3& m = camera.world_to_view;
  const auto view_normal = [&](int r) {
    VF v = hn::Mul(hn::Set(d, m[0][r]), own.normal[0]);
    v = hn::MulAdd(hn::Set(d, m[1][r]), own.normal[1], v);
    return hn::MulAdd(hn::Set(d, m[2][r]), own.normal[2], v);
  };
  Wanted w;
  w.own = own;
  const VF inverse_focal = hn::Set(d, 1.0f / camera.focal);
  w.x = hn::Mul(view_normal(0), inverse_focal);
  w.y = hn::Mul(view_normal(1), inverse_focal);
  w.c = hn::NegMulAdd(w.x, hn::Set(d, camera.center.x - 0.5f),
                      hn::NegMulAdd(w.y, hn::Set(d, camera.center.y - 0.5f), view_normal(2)));
  const VF along = hn::MulAdd(w.x, hn::Iota(d, static_cast<float>(x)),
                              hn::MulAdd(w.y, hn::Set(d, static_cast<float>(y)), w.c));
  w.distance = hn::Mul(own.depth, along);
  w.tolerance = hn::Mul(own.depth, hn::Set(d, options.plane_distance));
  w.cosine = hn::Set(d, options.normal_cosine);
  return w;
}

// Where the neighbors from column x of row y on show the same surface.
MF Same(const Wanted& w, const Seen& seen, int x, int y) {
  const F d;
  const VF along = hn::MulAdd(w.x, hn::Iota(d, static_cast<float>(x)),
                              hn::MulAdd(w.y, hn::Set(d, static_cast<float>(y)), w.c));
  const VF off = hn::Abs(hn::MulSub(along, seen.depth, w.distance));
  VF cosine = hn::Mul(w.own.normal[0], seen.normal[0]);
  cosine = hn::MulAdd(w.own.normal[1], seen.normal[1], cosine);
  cosine = hn::MulAdd(w.own.normal[2], seen.normal[2], cosine);
  return hn::And(hn::RebindMask(d, hn::Eq(seen.id, w.own.id)),
                 hn::And(hn::Le(off, w.tolerance), hn::Ge(cosine, w.cosine)));
}

// The same of the neighbors to the left (step -1) or right (1); what is beside the image does not
// count.
MF SameBeside(const Wanted& w, const GBuffer& surface, int x, int y, int step) {
  const F d;
  const VF column = hn::Iota(d, static_cast<float>(x + step));
  const VF width = hn::Set(d, static_cast<float>(surface.depth.width()));
  const MF outside = hn::Or(hn::Lt(column, hn::Zero(d)), hn::Ge(column, width));
  return hn::Or(outside, Same(w, Load(surface, x + step, y), x + step, y));
}

// Where all neighbors show the pixel's own surface.
MF IsInside(const FrameInput& frame, const TapOptions& options, int x, int y) {
  const GBuffer& surface = frame.surface;
  const Wanted wanted = Ask(frame, options, Load(surface, x, y), x, y);
  MF same = hn::And(SameBeside(wanted, surface, x, y, -1), SameBeside(wanted, surface, x, y, 1));
  if (y > 0) same = hn::And(same, Same(wanted, Load(surface, x, y - 1), x, y - 1));
  if (y + 1 < frame.extent().height) {
    same = hn::And(same, Same(wanted, Load(surface, x, y + 1), x, y + 1));
  }
  return same;
}

void FindEdges(const FrameInput& frame, const TapOptions& options, const Rect& tile,
               Plane<std::uint8_t>& edge) {
  const F d;
  const I di;
  const hn::Rebind<std::uint8_t, F> bytes;
  const VF blends = hn::Set(d, kBlends);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += static_cast<int>(hn::Lanes(d))) {
      const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
      prefetch_below(frame.surface.depth, x, y);
      const VF blend = hn::Add(OffWhole(load(frame.motion[0])), OffWhole(load(frame.motion[1])));
      const VI id =
          hn::LoadU(di, reinterpret_cast<const std::int32_t*>(frame.surface.id.row(y)) + x);
      MF found = hn::And(hn::RebindMask(d, hn::Ne(id, hn::Zero(di))), hn::Gt(blend, blends));
      if (!hn::AllFalse(d, found)) found = hn::AndNot(IsInside(frame, options, x, y), found);
      const VI flag = hn::IfThenElseZero(hn::RebindMask(di, found), hn::Set(di, 1));
      hn::StoreU(hn::DemoteTo(bytes, flag), bytes, edge.row(y) + x);
    }
  }
}

void ShortenAges(const Plane<std::uint8_t>& edge, const Plane<float>& samples,
                 const LongestAges& longest, const Rect& tile, Plane<float>& age) {
  const F d;
  const I di;
  const hn::Rebind<std::uint8_t, F> bytes;
  const VF inside = hn::Set(d, longest.inside), at_edges = hn::Set(d, longest.at_edges);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += static_cast<int>(hn::Lanes(d))) {
      prefetch_below(edge, x, y);
      const VI flag = hn::PromoteTo(di, hn::LoadU(bytes, edge.row(y) + x));
      const MF is_edge = hn::RebindMask(d, hn::Ne(flag, hn::Zero(di)));
      const VF most =
          hn::Max(hn::IfThenElse(is_edge, at_edges, inside), hn::LoadU(d, samples.row(y) + x));
      float* n = age.row(y) + x;
      hn::StoreU(hn::Min(hn::LoadU(d, n), most), d, n);
    }
  }
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
