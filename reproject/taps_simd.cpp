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

Seen GatherSeen(const GBuffer& surface, VI x, VI y) {
  const F d;
  const I di;
  const auto offset = [&](std::size_t stride) {
    return hn::Add(hn::Mul(y, hn::Set(di, static_cast<int>(stride))), x);
  };
  const VI at = offset(surface.depth.stride());
  return {{hn::GatherIndex(d, surface.normal[0].row(0), at),
           hn::GatherIndex(d, surface.normal[1].row(0), at),
           hn::GatherIndex(d, surface.normal[2].row(0), at)},
          hn::GatherIndex(d, surface.depth.row(0), at),
          hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(surface.id.row(0)),
                          offset(surface.id.stride()))};
}

// The same where the taps of all lanes stand side by side from (x, y) on.
Seen LoadSeen(const GBuffer& surface, int x, int y) {
  const F d;
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  return {{load(surface.normal[0]), load(surface.normal[1]), load(surface.normal[2])},
          load(surface.depth),
          hn::LoadU(I(), reinterpret_cast<const std::int32_t*>(surface.id.row(y)) + x)};
}

MF TapValid(const Seen& seen, float normal_cosine, const Wanted& wanted, const Rays& rays, VI x,
            VI y) {
  const F d;
  const VF half = hn::Set(d, 0.5f);
  const VF ray_x = rays.X(hn::Add(hn::ConvertTo(d, x), half));
  const VF ray_y = rays.Y(hn::Add(hn::ConvertTo(d, y), half));
  const VF along = hn::MulAdd(wanted.view_normal.x, ray_x,
                              hn::MulAdd(wanted.view_normal.y, ray_y, wanted.view_normal.z));
  const VF distance = hn::Abs(hn::Sub(hn::Mul(seen.depth, along), wanted.plane));
  const MF same = hn::RebindMask(d, hn::Eq(seen.id, wanted.id));
  return hn::And(same, hn::And(hn::Le(distance, wanted.tolerance),
                               hn::Ge(Dot(seen.normal, wanted.normal), hn::Set(d, normal_cosine))));
}

// The pixel's own surface, and q = p + motion(p) in units of pixel centers.
struct Query {
  Wanted wanted;
  VF x, y;
  MF valid;
};

Query LoadQuery(const Frame& current, const PreviousSurface& previous, const TapOptions& options,
                const Rays& rays, int x, int y) {
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

// Where the upper left taps of all valid lanes stand side by side in one row, with all four taps of
// each inside the image, the tap of the first lane. That is almost everywhere, and plain loads take
// a fraction of the time of gathers.
struct Run {
  bool found = false;
  int x = 0, y = 0;
};

Run FindRun(VI x0, VI y0, MF valid, Extent extent) {
  const I di;
  const int lanes = static_cast<int>(hn::Lanes(di));
  const auto known = hn::RebindMask(di, valid);
  const std::intptr_t lane = hn::FindFirstTrue(di, known);
  if (lane < 0) return {};
  const VI start = hn::Sub(x0, hn::Iota(di, 0));
  alignas(64) std::int32_t x[HWY_MAX_BYTES / sizeof(std::int32_t)];
  alignas(64) std::int32_t y[HWY_MAX_BYTES / sizeof(std::int32_t)];
  hn::Store(start, di, x);
  hn::Store(y0, di, y);
  const Run run{true, x[lane], y[lane]};
  const auto same = hn::And(hn::Eq(start, hn::Set(di, run.x)), hn::Eq(y0, hn::Set(di, run.y)));
  const bool inside =
      run.x >= 0 && run.x + lanes < extent.width && run.y >= 0 && run.y + 1 < extent.height;
  return inside && hn::AllTrue(di, hn::Or(same, hn::Not(known))) ? run : Run{};
}

// Asks for what the row below will read: its own pixels, and the lower taps of a run.
void PrefetchBelow(const Frame& current, const GBuffer& previous, const Run& run, int x, int y) {
  const auto guides = [](const GBuffer& surface, int column, int row) {
    for (const auto& plane : surface.normal) prefetch_below(plane, column, row);
    prefetch_below(surface.id, column, row);
  };
  for (const auto& plane : current.motion) prefetch_below(plane, x, y);
  prefetch_below(current.previous_depth, x, y);
  guides(current.surface, x, y);
  if (!run.found) return;
  prefetch_below(previous.depth, run.x, run.y + 1);
  guides(previous, run.x, run.y + 1);
}

void ComputeTaps(const Frame& current, const PreviousSurface& previous, const TapOptions& options,
                 const Tile& row, TapSegment& taps) {
  const F d;
  const I di;
  const Rays rays(previous.camera);
  const Extent extent = previous.surface.depth.extent();
  const VI last_x = hn::Set(di, extent.width - 1), last_y = hn::Set(di, extent.height - 1);
  const VI zero = hn::Zero(di);
  const VF one = hn::Set(d, 1.0f);
  const int lanes = static_cast<int>(hn::Lanes(d));

  for (int x = row.x0; x < row.x1; x += lanes) {
    const Query q = LoadQuery(current, previous, options, rays, x, row.y0);
    const VF floor_x = hn::Floor(q.x), floor_y = hn::Floor(q.y);
    const VF fx = hn::Sub(q.x, floor_x), fy = hn::Sub(q.y, floor_y);
    const VI x0 = hn::ConvertTo(di, floor_x), y0 = hn::ConvertTo(di, floor_y);
    const VF wx[2] = {hn::Sub(one, fx), fx}, wy[2] = {hn::Sub(one, fy), fy};
    const Run run = FindRun(x0, y0, q.valid, extent);
    PrefetchBelow(current, previous.surface, run, x, row.y0);

    const auto at = static_cast<std::size_t>(x - row.x0);
    VF weight[4], sum = hn::Zero(d);
    for (int t = 0; t < 4; ++t) {
      const int right = t & 1, down = t >> 1;
      const VI tx = hn::Add(x0, hn::Set(di, right)), ty = hn::Add(y0, hn::Set(di, down));
      const VI cx = hn::Min(hn::Max(tx, zero), last_x), cy = hn::Min(hn::Max(ty, zero), last_y);
      const MF inside = hn::RebindMask(d, hn::And(hn::Eq(tx, cx), hn::Eq(ty, cy)));
      const Seen seen = run.found ? LoadSeen(previous.surface, run.x + right, run.y + down)
                                  : GatherSeen(previous.surface, cx, cy);
      const MF valid = hn::And(hn::And(q.valid, inside),
                               TapValid(seen, options.normal_cosine, q.wanted, rays, cx, cy));
      weight[t] = hn::IfThenElseZero(valid, hn::Mul(wx[right], wy[down]));
      sum = hn::Add(sum, weight[t]);
      hn::Store(cx, di, taps.x[static_cast<std::size_t>(t)].data() + at);
      hn::Store(cy, di, taps.y[static_cast<std::size_t>(t)].data() + at);
    }
    // A sum below 1 % is one far corner that happened to pass: nothing to trust.
    const MF enough = hn::Ge(sum, hn::Set(d, 0.01f));
    const VF scale = hn::IfThenElseZero(enough, hn::Div(one, sum));
    for (int t = 0; t < 4; ++t) {
      hn::Store(hn::IfThenElseZero(enough, hn::Mul(weight[t], scale)), d,
                taps.weight[static_cast<std::size_t>(t)].data() + at);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(ComputeTaps);

void compute_taps(const Frame& current, const PreviousSurface& previous, const TapOptions& options,
                  const Tile& row, TapSegment& taps) {
  EL_DCHECK(row.x1 - row.x0 <= kSegment);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(ComputeTaps)(current, previous, options, row, taps);
}

}  // namespace eigenlight
#endif
