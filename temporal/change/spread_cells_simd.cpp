#include <algorithm>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/spread_cells_simd.cpp"
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

// What a vector of pixels asks of the cells around, and what it got.
struct Taker {
  VF normal[3], view_normal[3];
  VF plane, tolerance;  // N . X, and the distance off the plane that is still the same surface
  VI id;
  VF sum[3], weight;
};

struct View {
  const ResidualCells& cells;
  const Camera& camera;

  // N . ray through a pixel coordinate of the frame of cells.
  [[nodiscard]] VF Along(const VF (&n)[3], VF x, VF y) const {
    const F d;
    const VF scale = hn::Set(d, 1.0f / camera.focal);
    const VF ray_x = hn::Mul(hn::Sub(x, hn::Set(d, camera.center.x)), scale);
    const VF ray_y = hn::Mul(hn::Sub(y, hn::Set(d, camera.center.y)), scale);
    return hn::MulAdd(n[0], ray_x, hn::MulAdd(n[1], ray_y, n[2]));
  }
};

Taker LoadTaker(const View& view, const FrameInput& frame, const TapOptions& taps, int x, int y) {
  const F d;
  const auto load = [&](const Plane<float>& plane) {
    prefetch_below(plane, x, y);
    return hn::LoadU(d, plane.row(y) + x);
  };
  Taker taker;
  for (std::size_t c = 0; c < 3; ++c) taker.normal[c] = load(frame.surface.normal[c]);
  const glm::mat3& m = view.camera.world_to_view;
  for (int r = 0; r < 3; ++r) {
    taker.view_normal[r] = hn::MulAdd(hn::Set(d, m[0][r]), taker.normal[0],
                                      hn::MulAdd(hn::Set(d, m[1][r]), taker.normal[1],
                                                 hn::Mul(hn::Set(d, m[2][r]), taker.normal[2])));
  }
  // Pixel x has the ray of coordinate x / 2 + 0.5 among cells.
  const VF half = hn::Set(d, 0.5f);
  const VF column = hn::MulAdd(hn::Iota(d, static_cast<float>(x)), half, half);
  const VF line = hn::Set(d, 0.5f * static_cast<float>(y) + 0.5f);
  const VF depth = load(frame.surface.depth);
  taker.plane = hn::Mul(depth, view.Along(taker.view_normal, column, line));
  taker.tolerance = hn::Mul(depth, hn::Set(d, taps.plane_distance));
  prefetch_below(frame.surface.id, x, y);
  taker.id = hn::LoadU(I(), reinterpret_cast<const std::int32_t*>(frame.surface.id.row(y)) + x);
  for (auto& sum : taker.sum) sum = hn::Zero(d);
  taker.weight = hn::Zero(d);
  return taker;
}

// Weight of a cell that shows another part of the same object, against one of the same surface: it
// counts where there is no other.
constexpr float kOtherSurface = 1e-3f;

// The cells of a vector of pixels in one row of cells: each pixel's own column, or the one beyond
// its nearer edge.
enum class Column { kOwn, kOther };

// Anywhere in the image.
struct ScatteredCells {
  VI own, other;

  ScatteredCells(int x, int width) {
    const I d;
    const VI column = hn::Iota(d, x), one = hn::Set(d, 1), last = hn::Set(d, width - 1);
    const VI odd = hn::And(column, one);
    own = hn::Min(hn::ShiftRight<1>(column), last);
    other = hn::Min(hn::Max(hn::Add(own, hn::Sub(hn::Add(odd, odd), one)), hn::Zero(d)), last);
  }
  template <Column kColumn>
  [[nodiscard]] VI Index() const {
    return kColumn == Column::kOwn ? own : other;
  }
  template <Column kColumn, typename D>
  [[nodiscard]] hn::Vec<D> Fetch(D d, const hn::TFromD<D>* row) const {
    return hn::GatherIndex(d, row, Index<kColumn>());
  }
};

// Where a whole vector from the column left of the first pixel's lies in the image: that one load
// holds the cells of all lanes, if they are four or more.
struct InnerCells {
  VI own, other;  // among the loaded
  int first;

  static bool fit(int x, int width) {
    const int lanes = static_cast<int>(hn::Lanes(I()));
    return lanes >= 4 && x >= 2 && x / 2 - 1 + lanes <= width;
  }
  explicit InnerCells(int x) : first(x / 2 - 1) {
    const I d;
    const VI lane = hn::Iota(d, 0), one = hn::Set(d, 1), odd = hn::And(lane, one);
    own = hn::Add(hn::ShiftRight<1>(lane), one);
    other = hn::Add(own, hn::Sub(hn::Add(odd, odd), one));
  }
  template <Column kColumn>
  [[nodiscard]] VI Index() const {
    return hn::Add(kColumn == Column::kOwn ? own : other, hn::Set(I(), first));
  }
  template <Column kColumn, typename D>
  [[nodiscard]] hn::Vec<D> Fetch(D d, const hn::TFromD<D>* row) const {
    const auto index = hn::IndicesFromVec(d, kColumn == Column::kOwn ? own : other);
    return hn::TableLookupLanes(hn::LoadU(d, row + first), index);
  }
};

template <Column kColumn, typename Cells>
HWY_INLINE void TakeCells(const View& view, float normal_cosine, const Cells& at, int y,
                          float kernel, Taker& taker) {
  const F d;
  const GBuffer& surface = view.cells.guides.surface;
  const auto fetch = [&](const Plane<float>& plane) {
    return at.template Fetch<kColumn>(d, plane.row(y));
  };
  const VI id =
      at.template Fetch<kColumn>(I(), reinterpret_cast<const std::int32_t*>(surface.id.row(y)));
  const VF x = hn::ConvertTo(d, at.template Index<kColumn>());
  const VF along = view.Along(taker.view_normal, hn::Add(x, hn::Set(d, 0.5f)),
                              hn::Set(d, static_cast<float>(y) + 0.5f));
  const VF distance = hn::Abs(hn::MulSub(fetch(surface.depth), along, taker.plane));
  VF cosine = hn::Mul(taker.normal[0], fetch(surface.normal[0]));
  cosine = hn::MulAdd(taker.normal[1], fetch(surface.normal[1]), cosine);
  cosine = hn::MulAdd(taker.normal[2], fetch(surface.normal[2]), cosine);
  const auto same =
      hn::And(hn::Le(distance, taker.tolerance), hn::Ge(cosine, hn::Set(d, normal_cosine)));
  const VF weight = hn::IfThenElseZero(
      hn::RebindMask(d, hn::Eq(id, taker.id)),
      hn::IfThenElse(same, hn::Set(d, kernel), hn::Set(d, kOtherSurface * kernel)));
  for (std::size_t c = 0; c < 3; ++c) {
    taker.sum[c] = hn::MulAdd(weight, fetch(view.cells.mean[c]), taker.sum[c]);
  }
  taker.weight = hn::Add(taker.weight, weight);
}

// A pixel's own cell weighs 3/4 along each axis, the one beyond its nearer edge 1/4.
template <typename Cells>
HWY_INLINE void TakeAround(const View& view, const TapOptions& taps, const Cells& at, int own,
                           int other, Taker& taker) {
  const float cosine = taps.normal_cosine;
  TakeCells<Column::kOwn>(view, cosine, at, own, 9.0f / 16, taker);
  TakeCells<Column::kOther>(view, cosine, at, own, 3.0f / 16, taker);
  TakeCells<Column::kOwn>(view, cosine, at, other, 3.0f / 16, taker);
  TakeCells<Column::kOther>(view, cosine, at, other, 1.0f / 16, taker);
}

void GiveTaker(const Taker& taker, int x, int y, const SpreadOutputs& out) {
  const F d;
  float* const innovation = out.innovation.row(y) + x;
  const VF before = hn::LoadU(d, innovation);
  const auto takes = hn::AndNot(hn::IsNaN(before), hn::Gt(taker.weight, hn::Zero(d)));
  const VF one = hn::Set(d, 1.0f);
  const VF scale =
      hn::IfThenElseZero(takes, hn::Div(one, hn::IfThenElse(takes, taker.weight, one)));
  VF given[3];
  for (std::size_t c = 0; c < 3; ++c) {
    prefetch_below(out.correction[c], x, y);
    given[c] = hn::Mul(taker.sum[c], scale);
    hn::StoreU(given[c], d, out.correction[c].row(y) + x);
  }
  prefetch_below(out.innovation, x, y);
  const VF luminance =
      hn::MulAdd(hn::Set(d, 0.2126f), given[0],
                 hn::MulAdd(hn::Set(d, 0.7152f), given[1], hn::Mul(hn::Set(d, 0.0722f), given[2])));
  hn::StoreU(hn::Sub(before, luminance), d, innovation);
}

void SpreadCells(const ResidualCells& cells, const FrameInput& guides, const Rect& tile,
                 const SpreadOutputs& out) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  const View view{cells, cells.guides.camera};
  const Extent extent = cells.extent();
  const TapOptions& taps = cells.taps;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const int own = y / 2, other = std::clamp(own + 2 * (y & 1) - 1, 0, extent.height - 1);
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      Taker taker = LoadTaker(view, guides, taps, x, y);
      if (InnerCells::fit(x, extent.width)) {
        TakeAround(view, taps, InnerCells(x), own, other, taker);
      } else {
        TakeAround(view, taps, ScatteredCells(x, extent.width), own, other, taker);
      }
      GiveTaker(taker, x, y, out);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(SpreadCells);

void spread_cells(const ResidualCells& cells, const FrameInput& guides, const Rect& tile,
                  const SpreadOutputs& out) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(SpreadCells)(cells, guides, tile, out);
}

}  // namespace eigenlight
#endif
