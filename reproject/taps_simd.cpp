#include "reproject/taps.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/taps_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/surface-inl.h"
#include "reproject/tap_runs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// A vector of pixels whose surface is looked for in the previous frame.
struct Query {
  Surface own;
  VF3 view_normal;
  VF x, y;              // p + motion(p), in units of pixel centers
  VF plane, tolerance;  // N . X one frame ago, and how far off it a tap may be
  MF valid;
};

// Where (x, y) is inside the image or less than a pixel outside. False for NaN.
MF LeadsInto(Extent extent, VF x, VF y) {
  const auto within = [](VF v, int size) { return And(Gt(v, Set(-1)), Lt(v, Set(size))); };
  return And(within(x, extent.width), within(y, extent.height));
}

Query LoadQuery(const FrameInput& current, const PreviousSurface& previous,
                const TapOptions& options, const Rays& rays, int x, int y) {
  Query q;
  q.own = LoadSurface(current.surface, x, y);
  const VF depth = LoadAndPrefetch(current.previous_depth, x, y);
  const VF column = Add(Iota(x), LoadAndPrefetch(current.motion[0], x, y));
  const VF line = Add(Set(y), LoadAndPrefetch(current.motion[1], x, y));
  PrefetchSurface(current.surface, x, y);

  const MF shown = RebindMask(F(), Ne(q.own.id, Zero(U())));
  const MF seen =
      And(Gt(depth, Zero()), Lt(depth, Set(std::numeric_limits<float>::max())));  // false for NaN
  q.valid = And(LeadsInto(previous.surface.depth.extent(), column, line), And(seen, shown));
  q.x = IfThenElseZero(q.valid, column);
  q.y = IfThenElseZero(q.valid, line);

  for (int r = 0; r < 3; ++r) {
    q.view_normal[r] = Dot(ViewAxis(previous.camera, r), q.own.normal);
  }
  q.tolerance = Mul(depth, Set(options.plane_distance));
  const VF half = Set(0.5f);
  q.plane = Mul(depth, rays.Along(q.view_normal, Add(q.x, half), Add(q.y, half)));
  return q;
}

// Whether taps show the surface that was asked for. `along`: N . ray of the taps, in view space.
MF IsSameSurface(const Query& q, const Surface& tap, VF along, const TapOptions& options) {
  const VF distance = Abs(Sub(Mul(tap.depth, along), q.plane));
  const MF same_plane =
      And(Le(distance, q.tolerance), Ge(Dot(tap.normal, q.own.normal), Set(options.normal_cosine)));
  return And(RebindMask(F(), Eq(tap.id, q.own.id)), same_plane);
}

// Bilinear weights along one axis of the taps at floor(q) and one on, 0 outside the image.
struct AxisWeights {
  VF weight[2];

  AxisWeights(VF q, VF floor, int size) {
    const VF upper = Sub(q, floor);
    weight[0] = IfThenElseZero(Ge(floor, Zero()), Sub(Set(1), upper));
    weight[1] = IfThenElseZero(Lt(floor, Set(size - 1)), upper);
  }
};

struct Weights {
  VF tap[4];

  // Scales them to a sum of 1. A sum below 1 % is dropped: only a far corner matched by chance.
  void Normalize() {
    const VF sum = Add(Add(tap[0], tap[1]), Add(tap[2], tap[3])), one = Set(1);
    const MF enough = Ge(sum, Set(0.01f));
    const VF scale = IfThenElseZero(enough, Div(one, IfThenElse(enough, sum, one)));
    for (VF& weight : tap) weight = Mul(weight, scale);
  }
};

// Sets the weights of a run's valid taps.
void WeighRun(const TapRun& run, const Query& q, const AxisWeights& wx, const AxisWeights& wy,
              const PreviousSurface& previous, const TapOptions& options, const Rays& rays,
              Weights& weights) {
  PrefetchSurface(previous.surface, run.x, run.y + 1);
  // Ray x of the left taps, from one lane to the next and from a tap to its neighbor.
  const VF ray_x = rays.X(Iota(static_cast<float>(run.x) + 0.5f));
  for (int down = 0; down < 2; ++down) {
    const int line = run.y + down;
    if (line < 0 || line >= previous.surface.depth.height()) continue;
    const VF ray_y = rays.Y(Set(static_cast<float>(line) + 0.5f));
    const VF3& normal = q.view_normal;
    VF along = MulAdd(normal[0], ray_x, MulAdd(normal[1], ray_y, normal[2]));
    for (int right = 0; right < 2; ++right) {
      const Surface tap = LoadSurface(previous.surface, run.x + right, line);
      const MF valid = And(run.lanes, IsSameSurface(q, tap, along, options));
      VF& weight = weights.tap[2 * down + right];
      weight = IfThenElse(valid, Mul(wx.weight[right], wy.weight[down]), weight);
      along = MulAdd(normal[0], rays.inverse_focal, along);
    }
  }
}

void ComputeTaps(const FrameInput& current, const PreviousSurface& previous,
                 const TapOptions& options, const Rect& row, TapSegment& taps) {
  const Rays rays(previous.camera);
  const Extent extent = previous.surface.depth.extent();
  ForEachVector(row, [&](int x, int y) {
    const Query q = LoadQuery(current, previous, options, rays, x, y);
    const VF floor_x = hn::Floor(q.x), floor_y = hn::Floor(q.y);
    const AxisWeights wx(q.x, floor_x, extent.width), wy(q.y, floor_y, extent.height);
    const int at = x - row.x0;
    Store(ConvertTo(I(), floor_x), I(), taps.x + at);
    Store(ConvertTo(I(), floor_y), I(), taps.y + at);
    Weights weights{{Zero(), Zero(), Zero(), Zero()}};
    ForEachRun(taps, at, And(q.valid, FirstLanes(row.x1 - x)), [&](const TapRun& run) {
      WeighRun(run, q, wx, wy, previous, options, rays, weights);
    });
    weights.Normalize();
    for (int t = 0; t < 4; ++t) Store(weights.tap[t], F(), taps.weight[t] + at);
  });
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
