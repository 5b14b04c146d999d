#include <algorithm>
#include <limits>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "reproject/taps.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/taps_simd.cpp"
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

// Three coordinates of a lane's point or direction.
struct Vec3 {
  VF x, y, z;
};

VF Dot(const Vec3& a, const Vec3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

// The camera's rays in the previous frame: view-space direction with z = 1 through a pixel.
struct Rays {
  VF inverse_focal, center_x, center_y;

  explicit Rays(const Camera& camera)
      : inverse_focal(hn::Set(F(), 1.0f / camera.focal)),
        center_x(hn::Set(F(), camera.center.x)),
        center_y(hn::Set(F(), camera.center.y)) {}
  VF X(VF x) const { return hn::Mul(hn::Sub(x, center_x), inverse_focal); }
  VF Y(VF y) const { return hn::Mul(hn::Sub(y, center_y), inverse_focal); }
};

// World to view of the previous camera.
Vec3 Rotate(const glm::mat3& m, const Vec3& v) {
  const auto row = [&](int r) {
    return Dot({hn::Set(F(), m[0][r]), hn::Set(F(), m[1][r]), hn::Set(F(), m[2][r])}, v);
  };
  return {row(0), row(1), row(2)};
}

// What a pixel asks of its taps.
struct Wanted {
  Vec3 normal, view_normal;
  VF plane;      // N . X
  VF tolerance;  // world units
  VI id;
};

// What the previous frame shows at a tap.
struct Seen {
  Vec3 normal;
  VF depth;
  VI id;
};

// The taps of a vector, side by side from (x, y) on.
Seen LoadSeen(const GBuffer& surface, int x, int y) {
  const F d;
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  return {{load(surface.normal[0]), load(surface.normal[1]), load(surface.normal[2])},
          load(surface.depth),
          hn::LoadU(I(), reinterpret_cast<const std::int32_t*>(surface.id.row(y)) + x)};
}

// `along`: N . ray(tap), both in view space.
MF TapValid(const Seen& seen, VF along, VF normal_cosine, const Wanted& wanted) {
  const F d;
  const VF distance = hn::Abs(hn::Sub(hn::Mul(seen.depth, along), wanted.plane));
  const MF same = hn::RebindMask(d, hn::Eq(seen.id, wanted.id));
  return hn::And(same, hn::And(hn::Le(distance, wanted.tolerance),
                               hn::Ge(Dot(seen.normal, wanted.normal), normal_cosine)));
}

// The pixel's own surface, and q = p + motion(p) in units of pixel centers.
struct Query {
  Wanted wanted;
  VF x, y;
  MF valid;
};

Query LoadQuery(const FrameInput& current, const PreviousSurface& previous,
                const TapOptions& options, const Rays& rays, int x, int y) {
  const F d;
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  Query q;
  const VF column = hn::Add(hn::Iota(d, static_cast<float>(x)), load(current.motion[0]));
  const VF line = hn::Add(hn::Set(d, static_cast<float>(y)), load(current.motion[1]));
  const VF depth = load(current.previous_depth);

  // Comparisons with NaN are false, so what is not finite ends here.
  const Extent extent = previous.surface.depth.extent();
  const auto within = [&](VF v, float low, float high) {
    return hn::And(hn::Gt(v, hn::Set(d, low)), hn::Lt(v, hn::Set(d, high)));
  };
  const VI id =
      hn::LoadU(I(), reinterpret_cast<const std::int32_t*>(current.surface.id.row(y)) + x);
  const MF surface = hn::RebindMask(d, hn::Ne(id, hn::Zero(I())));
  q.valid = hn::And(hn::And(within(column, -1.0f, static_cast<float>(extent.width)),
                            within(line, -1.0f, static_cast<float>(extent.height))),
                    hn::And(within(depth, 0.0f, std::numeric_limits<float>::max()), surface));
  q.x = hn::IfThenElseZero(q.valid, column);
  q.y = hn::IfThenElseZero(q.valid, line);

  q.wanted.normal = {load(current.surface.normal[0]), load(current.surface.normal[1]),
                     load(current.surface.normal[2])};
  q.wanted.view_normal = Rotate(previous.camera.world_to_view, q.wanted.normal);
  q.wanted.id = id;
  q.wanted.tolerance = hn::Mul(depth, hn::Set(d, options.plane_distance));
  const VF half = hn::Set(d, 0.5f);
  const Vec3 ray{rays.X(hn::Add(q.x, half)), rays.Y(hn::Add(q.y, half)), hn::Set(d, 1.0f)};
  q.wanted.plane = hn::Mul(depth, Dot(q.wanted.view_normal, ray));
  return q;
}

// Pixels of a vector whose taps stand side by side, the upper left one of lane i at (x + i, y).
// Most vectors are one run, and plain loads take a fraction of the time of gathers.
struct Run {
  int x, y;
  MF lanes;
};

// Takes the run of the first of the lanes that are `left` from them.
Run TakeRun(const TapSegment& taps, std::size_t at, MF& left) {
  const F d;
  const I di;
  const std::size_t first = hn::FindKnownFirstTrue(d, left);
  Run run{taps.x[at + first] - static_cast<int>(first), taps.y[at + first], {}};
  const VI x = hn::Sub(hn::Load(di, taps.x.data() + at), hn::Iota(di, 0));
  const VI y = hn::Load(di, taps.y.data() + at);
  const auto same = hn::And(hn::Eq(x, hn::Set(di, run.x)), hn::Eq(y, hn::Set(di, run.y)));
  run.lanes = hn::And(left, hn::RebindMask(d, same));
  left = hn::AndNot(run.lanes, left);
  return run;
}

// Ask for what the row below will read: of its own pixels, and of the lower taps of a run.
void PrefetchGuides(const GBuffer& surface, const Plane<float>& depth, int x, int y) {
  prefetch_below(depth, x, y);
  for (const auto& plane : surface.normal) prefetch_below(plane, x, y);
  prefetch_below(surface.id, x, y);
}

void PrefetchBelow(const FrameInput& current, int x, int y) {
  for (const auto& plane : current.motion) prefetch_below(plane, x, y);
  PrefetchGuides(current.surface, current.previous_depth, x, y);
}

// Weights along one axis of the taps at floor(q) and one on, 0 outside the image.
struct AxisWeights {
  VF weight[2];

  AxisWeights(VF q, VF floor, int size) {
    const F d;
    const VF high = hn::Sub(q, floor), last = hn::Set(d, static_cast<float>(size - 1));
    weight[0] = hn::IfThenElseZero(hn::Ge(floor, hn::Zero(d)), hn::Sub(hn::Set(d, 1.0f), high));
    weight[1] = hn::IfThenElseZero(hn::Lt(floor, last), high);
  }
};

// The weights of a run's valid taps, not yet scaled to sum 1.
void WeighRun(const Run& run, const Query& q, const AxisWeights& wx, const AxisWeights& wy,
              const PreviousSurface& previous, const TapOptions& options, const Rays& rays,
              VF (&weight)[4]) {
  const F d;
  const VF cosine = hn::Set(d, options.normal_cosine);
  const int height = previous.surface.depth.height();
  // Ray x of the left taps, from one lane to the next and from a tap to its neighbor.
  const VF ray_x = rays.X(hn::Iota(d, static_cast<float>(run.x) + 0.5f));
  for (int down = 0; down < 2; ++down) {
    const int line = run.y + down;
    if (line < 0 || line >= height) continue;
    const VF ray_y = rays.Y(hn::Set(d, static_cast<float>(line) + 0.5f));
    const Vec3& normal = q.wanted.view_normal;
    VF along = hn::MulAdd(normal.x, ray_x, hn::MulAdd(normal.y, ray_y, normal.z));
    for (int right = 0; right < 2; ++right) {
      const Seen seen = LoadSeen(previous.surface, run.x + right, line);
      const MF valid = hn::And(run.lanes, TapValid(seen, along, cosine, q.wanted));
      VF& w = weight[2 * down + right];
      w = hn::IfThenElse(valid, hn::Mul(wx.weight[right], wy.weight[down]), w);
      along = hn::MulAdd(normal.x, rays.inverse_focal, along);
    }
  }
}

void ComputeTaps(const FrameInput& current, const PreviousSurface& previous,
                 const TapOptions& options, const Rect& row, TapSegment& taps) {
  const F d;
  const I di;
  const Rays rays(previous.camera);
  const Extent extent = previous.surface.depth.extent();
  const VF one = hn::Set(d, 1.0f);
  const int lanes = static_cast<int>(hn::Lanes(d));

  for (int x = row.x0; x < row.x1; x += lanes) {
    const Query q = LoadQuery(current, previous, options, rays, x, row.y0);
    const VF floor_x = hn::Floor(q.x), floor_y = hn::Floor(q.y);
    const AxisWeights wx(q.x, floor_x, extent.width), wy(q.y, floor_y, extent.height);
    PrefetchBelow(current, x, row.y0);

    const auto at = static_cast<std::size_t>(x - row.x0);
    hn::Store(hn::ConvertTo(di, floor_x), di, taps.x.data() + at);
    hn::Store(hn::ConvertTo(di, floor_y), di, taps.y.data() + at);
    VF weight[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    MF left = hn::And(q.valid, hn::FirstN(d, static_cast<std::size_t>(row.x1 - x)));
    while (!hn::AllFalse(d, left)) {
      const Run run = TakeRun(taps, at, left);
      PrefetchGuides(previous.surface, previous.surface.depth, run.x, run.y + 1);
      WeighRun(run, q, wx, wy, previous, options, rays, weight);
    }
    const VF sum = hn::Add(hn::Add(weight[0], weight[1]), hn::Add(weight[2], weight[3]));
    // A sum below 1 % is one far corner that happened to pass: nothing to trust.
    const MF enough = hn::Ge(sum, hn::Set(d, 0.01f));
    const VF scale = hn::IfThenElseZero(enough, hn::Div(one, hn::IfThenElse(enough, sum, one)));
    for (std::size_t t = 0; t < 4; ++t) {
      hn::Store(hn::Mul(weight[t], scale), d, taps.weight[t].data() + at);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(ComputeTaps);

void compute_taps(const FrameInput& current, const PreviousSurface& previous,
                  const TapOptions& options, const Rect& row, TapSegment& taps) {
  EL_DCHECK(row.x1 - row.x0 <= kSegment);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(ComputeTaps)(current, previous, options, row, taps);
}

}  // namespace eigenlight
#endif
