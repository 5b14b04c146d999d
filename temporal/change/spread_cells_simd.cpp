#include <algorithm>

#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/spread_cells_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/surface-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// A vector of pixels, and what the cells around give them.
struct Taker {
  VF3 normal, view_normal;
  VF plane, tolerance;  // N . X, and the distance off the plane that is still the same surface
  VU id;
  VF3 sum;
  VF weight;
};

struct View {
  const ResidualCells& cells;
  Rays rays;
};

Taker LoadTaker(const View& view, const FrameInput& frame, int x, int y) {
  Taker taker;
  taker.normal = LoadAndPrefetch(frame.surface.normal, x, y);
  for (int r = 0; r < 3; ++r) {
    taker.view_normal[r] = Dot(ViewAxis(view.cells.guides.camera, r), taker.normal);
  }
  // Pixel x has the ray of coordinate x / 2 + 0.5 among cells.
  const VF half = Set(0.5f);
  const VF column = MulAdd(Iota(x), half, half);
  const VF line = Set(0.5f * static_cast<float>(y) + 0.5f);
  const VF depth = LoadAndPrefetch(frame.surface.depth, x, y);
  taker.plane = Mul(depth, view.rays.Along(taker.view_normal, column, line));
  taker.tolerance = Mul(depth, Set(view.cells.taps.plane_distance));
  prefetch_below(frame.surface.id, x, y);
  taker.id = Load(frame.surface.id, x, y, U());
  taker.sum = {{Zero(), Zero(), Zero()}};
  taker.weight = Zero();
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
    const VI column = Iota(d, x), one = Set(d, 1), last = Set(d, width - 1);
    const VI odd = And(column, one);
    own = Min(hn::ShiftRight<1>(column), last);
    other = Min(Max(Add(own, Sub(Add(odd, odd), one)), Zero(d)), last);
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
    const int lanes = LaneCount(I());
    return lanes >= 4 && x >= 2 && x / 2 - 1 + lanes <= width;
  }
  explicit InnerCells(int x) : first(x / 2 - 1) {
    const I d;
    const VI lane = Iota(d, 0), one = Set(d, 1), odd = And(lane, one);
    own = Add(hn::ShiftRight<1>(lane), one);
    other = Add(own, Sub(Add(odd, odd), one));
  }
  template <Column kColumn>
  [[nodiscard]] VI Index() const {
    return Add(kColumn == Column::kOwn ? own : other, Set(I(), first));
  }
  template <Column kColumn, typename D>
  [[nodiscard]] hn::Vec<D> Fetch(D d, const hn::TFromD<D>* row) const {
    const auto index = hn::IndicesFromVec(d, kColumn == Column::kOwn ? own : other);
    return hn::TableLookupLanes(LoadU(d, row + first), index);
  }
};

template <Column kColumn, typename Cells>
HWY_INLINE void TakeCells(const View& view, const Cells& at, int y, float kernel, Taker& taker) {
  const GBuffer& surface = view.cells.guides.surface;
  const auto fetch = [&](const Plane<float>& plane) {
    return at.template Fetch<kColumn>(F(), plane.row(y));
  };
  const VU id = at.template Fetch<kColumn>(U(), surface.id.row(y));
  const VF x = ConvertTo(F(), at.template Index<kColumn>());
  const VF along =
      view.rays.Along(taker.view_normal, Add(x, Set(0.5f)), Set(static_cast<float>(y) + 0.5f));
  const VF distance = Abs(MulSub(fetch(surface.depth), along, taker.plane));
  const VF cosine =
      DotInOrder(taker.normal,
                 {{fetch(surface.normal[0]), fetch(surface.normal[1]), fetch(surface.normal[2])}});
  const MF same =
      And(Le(distance, taker.tolerance), Ge(cosine, Set(view.cells.taps.normal_cosine)));
  const VF weight = IfThenElseZero(RebindMask(F(), Eq(id, taker.id)),
                                   IfThenElse(same, Set(kernel), Set(kOtherSurface * kernel)));
  for (int c = 0; c < 3; ++c) {
    taker.sum[c] = MulAdd(weight, fetch(view.cells.mean[c]), taker.sum[c]);
  }
  taker.weight = Add(taker.weight, weight);
}

// A pixel's own cell weighs 3/4 along each axis, the one beyond its nearer edge 1/4.
template <typename Cells>
HWY_INLINE void TakeAround(const View& view, const Cells& at, int own, int other, Taker& taker) {
  TakeCells<Column::kOwn>(view, at, own, 9.0f / 16, taker);
  TakeCells<Column::kOther>(view, at, own, 3.0f / 16, taker);
  TakeCells<Column::kOwn>(view, at, other, 3.0f / 16, taker);
  TakeCells<Column::kOther>(view, at, other, 1.0f / 16, taker);
}

void GiveTaker(const Taker& taker, int x, int y, const SpreadOutputs& out) {
  const VF before = LoadAndPrefetch(out.innovation, x, y), one = Set(1);
  const MF takes = AndNot(IsNaN(before), Gt(taker.weight, Zero()));
  const VF scale = IfThenElseZero(takes, Div(one, IfThenElse(takes, taker.weight, one)));
  VF3 given;
  for (int c = 0; c < 3; ++c) {
    given[c] = Mul(taker.sum[c], scale);
    StoreAndPrefetch(given[c], out.correction[c], x, y);
  }
  Store(Sub(before, Luminance(given)), out.innovation, x, y);
}

void SpreadCells(const ResidualCells& cells, const FrameInput& guides, const Rect& tile,
                 const SpreadOutputs& out) {
  const View view{cells, Rays(cells.guides.camera)};
  const Extent extent = cells.extent();
  ForEachVector(tile, [&](int x, int y) {
    const int own = y / 2, other = std::clamp(own + 2 * (y & 1) - 1, 0, extent.height - 1);
    Taker taker = LoadTaker(view, guides, x, y);
    if (InnerCells::fit(x, extent.width)) {
      TakeAround(view, InnerCells(x), own, other, taker);
    } else {
      TakeAround(view, ScatteredCells(x, extent.width), own, other, taker);
    }
    GiveTaker(taker, x, y, out);
  });
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
