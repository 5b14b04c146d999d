#include <algorithm>

#include "frame/strips.h"
#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/spread_cells_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/surface-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// A vector of pixels that asks the cells around.
struct Taker {
  VF3 normal, view_normal;
  VF plane, tolerance;  // N . X, and the distance off the plane that is still the same surface
  VU id;
};

// What four cells around give.
struct Given {
  VF3 sum;
  VF weight;
};

struct View {
  const ResidualCells& cells;  // for their geometry
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
HWY_INLINE VF WeighCells(const View& view, const Cells& at, int y, float kernel,
                         const Taker& taker) {
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
  return IfThenElseZero(RebindMask(F(), Eq(id, taker.id)),
                        IfThenElse(same, Set(kernel), Set(kOtherSurface * kernel)));
}

template <Column kColumn, typename Cells>
HWY_INLINE void TakeCells(const ResidualCells& cells, const Cells& at, int y, VF weight,
                          Given& given) {
  for (int c = 0; c < 3; ++c) {
    const VF mean = at.template Fetch<kColumn>(F(), cells.mean[c].row(y));
    given.sum[c] = MulAdd(weight, mean, given.sum[c]);
  }
  given.weight = Add(given.weight, weight);
}

// Rows of cells around a row of pixels: its own, and the one beyond its nearer edge.
struct CellRows {
  int own, other;

  CellRows(int y, int height)
      : own(y / 2), other(std::clamp(own + 2 * (y & 1) - 1, 0, height - 1)) {}
};

// Weights of the four cells around each pixel of a vector.
struct Weights {
  VF of[4];
};

// A pixel's own cell weighs 3/4 along each axis, the one beyond its nearer edge 1/4.
template <typename Cells>
HWY_INLINE Weights WeighAround(const View& view, const Cells& at, const CellRows& rows,
                               const Taker& taker) {
  return {{WeighCells<Column::kOwn>(view, at, rows.own, 9.0f / 16, taker),
           WeighCells<Column::kOther>(view, at, rows.own, 3.0f / 16, taker),
           WeighCells<Column::kOwn>(view, at, rows.other, 3.0f / 16, taker),
           WeighCells<Column::kOther>(view, at, rows.other, 1.0f / 16, taker)}};
}

template <typename Cells>
HWY_INLINE Given TakeAround(const ResidualCells& cells, const Cells& at, const CellRows& rows,
                            const Weights& weights) {
  Given given{{{Zero(), Zero(), Zero()}}, Zero()};
  TakeCells<Column::kOwn>(cells, at, rows.own, weights.of[0], given);
  TakeCells<Column::kOther>(cells, at, rows.own, weights.of[1], given);
  TakeCells<Column::kOwn>(cells, at, rows.other, weights.of[2], given);
  TakeCells<Column::kOther>(cells, at, rows.other, weights.of[3], given);
  return given;
}

HWY_INLINE void Give(const Given& given, int x, int y, const SpreadOutputs& out) {
  const VF before = LoadAndPrefetch(out.innovation, x, y), one = Set(1);
  const MF takes = AndNot(IsNaN(before), Gt(given.weight, Zero()));
  const VF scale = IfThenElseZero(takes, Div(one, IfThenElse(takes, given.weight, one)));
  VF3 mean;
  for (int c = 0; c < 3; ++c) {
    mean[c] = Mul(given.sum[c], scale);
    StoreAndPrefetch(mean[c], out.correction[c], x, y);
  }
  Store(Sub(before, Luminance(mean)), out.innovation, x, y);
}

// Calls visit(cells) with where the cells around a vector of pixels lie.
template <typename Visit>
HWY_INLINE void AtCells(int x, int width, const Visit& visit) {
  if (InnerCells::fit(x, width)) return visit(InnerCells(x));
  visit(ScatteredCells(x, width));
}

void SpreadAlone(const SpreadLayer& layer, const FrameInput& guides, const Rect& tile) {
  const ResidualCells& cells = layer.cells;
  const View view{cells, Rays(cells.guides.camera)};
  const Extent extent = cells.extent();
  ForEachVector(tile, [&](int x, int y) {
    const CellRows rows(y, extent.height);
    const Taker taker = LoadTaker(view, guides, x, y);
    AtCells(x, extent.width, [&](const auto& at) {
      const Weights weights = WeighAround(view, at, rows, taker);
      Give(TakeAround(cells, at, rows, weights), x, y, layer.out);
    });
  });
}

// Weights of a row of pixels.
struct WeightRow {
  static constexpr int kPixels = kStripWidth;

  alignas(64) float of[4][kPixels];
};

// At most kPixels of one row: weights first, then one layer after the other, which are streams of
// memory of their own.
void SpreadRow(std::span<const SpreadLayer> layers, const FrameInput& guides, const Rect& row) {
  const ResidualCells& first = layers.front().cells;
  const View view{first, Rays(first.guides.camera)};
  const Extent extent = first.extent();
  const CellRows rows(row.y0, extent.height);
  WeightRow weights;
  ForEachVector(row, [&](int x, int y) {
    const Taker taker = LoadTaker(view, guides, x, y);
    AtCells(x, extent.width, [&](const auto& at) {
      const Weights found = WeighAround(view, at, rows, taker);
      for (int i = 0; i < 4; ++i) Store(found.of[i], F(), weights.of[i] + x - row.x0);
    });
  });
  for (const SpreadLayer& layer : layers) {
    ForEachVector(row, [&](int x, int y) {
      Weights found;
      for (int i = 0; i < 4; ++i) found.of[i] = Load(F(), weights.of[i] + x - row.x0);
      AtCells(x, extent.width, [&](const auto& at) {
        Give(TakeAround(layer.cells, at, rows, found), x, y, layer.out);
      });
    });
  }
}

void SpreadCells(std::span<const SpreadLayer> layers, const FrameInput& guides, const Rect& tile) {
  if (layers.size() == 1) return SpreadAlone(layers.front(), guides, tile);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += WeightRow::kPixels) {
      SpreadRow(layers, guides, {x, y, std::min(x + WeightRow::kPixels, tile.x1), y + 1});
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(SpreadCells);

void spread_cells(std::span<const SpreadLayer> layers, const FrameInput& guides, const Rect& tile) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(SpreadCells)(layers, guides, tile);
}

}  // namespace eigenlight
#endif
