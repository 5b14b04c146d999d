#include <algorithm>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "temporal/edge_ages.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/edge_ages_simd.cpp"
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

// One lane on by `step` of -1 or 1, but for the lane that has no next one, which stays.
Seen Shift(const Seen& own, int step) {
  const F d;
  const I di;
  const VI last = hn::Set(di, static_cast<int>(hn::Lanes(di)) - 1);
  const VI next = hn::Add(hn::Iota(di, 0), hn::Set(di, step));
  const VI lane = hn::Min(hn::Max(next, hn::Zero(di)), last);
  const auto from = hn::IndicesFromVec(d, lane);
  const auto shift = [&](VF v) { return hn::TableLookupLanes(v, from); };
  return {{shift(own.normal[0]), shift(own.normal[1]), shift(own.normal[2])},
          shift(own.depth),
          hn::TableLookupLanes(own.id, hn::IndicesFromVec(di, lane))};
}

// What pixels ask of their neighbors.
struct Wanted {
  Seen own;
  VF x, y, c;              // N . ray(column, line) = x column + y line + c
  VF distance, tolerance;  // N . X; of the plane
  VF cosine;
};

Wanted Ask(const Frame& frame, const TapOptions& options, const Seen& own, int x, int y) {
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
// count. At its edges the pixels themselves hold all the neighbors, and rows may end in memory.
MF SameBeside(const Wanted& w, const Frame& frame, int x, int y, int step) {
  const F d;
  const int width = frame.extent().width, lanes = static_cast<int>(hn::Lanes(d));
  const bool loads = step < 0 ? x > 0 : x + lanes < width;
  if (loads) return Same(w, Load(frame.surface, x + step, y), x + step, y);
  const VF column = hn::Iota(d, static_cast<float>(x + step));
  const MF outside =
      hn::Or(hn::Lt(column, hn::Zero(d)), hn::Ge(column, hn::Set(d, static_cast<float>(width))));
  return hn::Or(outside, Same(w, Shift(w.own, step), x + step, y));
}

// Where all neighbors show the pixel's own surface.
MF IsInside(const Frame& frame, const TapOptions& options, int x, int y) {
  const GBuffer& surface = frame.surface;
  const Wanted wanted = Ask(frame, options, Load(surface, x, y), x, y);
  MF same = hn::And(SameBeside(wanted, frame, x, y, -1), SameBeside(wanted, frame, x, y, 1));
  if (y > 0) same = hn::And(same, Same(wanted, Load(surface, x, y - 1), x, y - 1));
  if (y + 1 < frame.extent().height) {
    same = hn::And(same, Same(wanted, Load(surface, x, y + 1), x, y + 1));
  }
  return same;
}

void ShortenEdgeAges(const EdgeInputs& in, const TapOptions& options, float longest,
                     const Tile& tile, Plane<float>& age) {
  const F d;
  const I di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF most = hn::Set(d, longest), blends = hn::Set(d, kBlends);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      const auto load = [&](const Plane<float>& plane) {
        prefetch_below(plane, x, y);
        return hn::LoadU(d, plane.row(y) + x);
      };
      const VF old = load(age), bound = hn::Max(most, load(in.samples));
      const VF blend =
          hn::Add(OffWhole(load(in.frame.motion[0])), OffWhole(load(in.frame.motion[1])));
      const VI id =
          hn::LoadU(di, reinterpret_cast<const std::int32_t*>(in.frame.surface.id.row(y)) + x);
      const MF shown = hn::RebindMask(d, hn::Ne(id, hn::Zero(di)));
      const MF asked = hn::And(shown, hn::And(hn::Gt(old, bound), hn::Gt(blend, blends)));
      if (hn::AllFalse(d, asked)) continue;
      const MF edge = hn::AndNot(IsInside(in.frame, options, x, y), asked);
      hn::StoreU(hn::IfThenElse(edge, bound, old), d, age.row(y) + x);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(ShortenEdgeAges);

void shorten_edge_ages(const EdgeInputs& in, const TapOptions& options, float longest,
                       const Tile& tile, Plane<float>& age) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(ShortenEdgeAges)(in, options, longest, tile, age);
}

}  // namespace eigenlight
#endif
