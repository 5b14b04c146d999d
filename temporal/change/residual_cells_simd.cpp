#include <algorithm>

#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/residual_cells_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// Squared standard deviations of a block's mean that count as chance: 0.3 % of normal noise, some 2
// % of path-traced noise with its heavy tail; and the pixels a block must have to be asked at all.
constexpr double kBlockChance = 9.0;
constexpr int kBlockPixels = 16;

// Vectors are a row of a block, or as many cells: both columns of their pixels lie inside the
// padding of a row.

// v (1/s + 1/n) where `used`, else 0.
VF8 ResidualVariance(MF8 used, VF8 variance, VF8 samples, VF8 age) {
  const F8 d;
  const VF8 one = Set(d, 1.0f);
  const VF8 s = IfThenElse(used, samples, one), n = IfThenElse(used, age, one);
  return IfThenElseZero(used, Mul(variance, Add(Div(one, s), Div(one, n))));
}

// Sums over the rows of some blocks side by side, for each column of pixels.
struct ColumnSums {
  static constexpr int kColumns = 256;

  alignas(64) float innovation[kColumns], noise[kColumns], count[kColumns];
};

// Adds a row of at most kColumns pixels.
void AddRow(const CorrectionInputs& in, const Rect& row, ColumnSums& sums) {
  const F8 d;
  for (int x = row.x0; x < row.x1; x += LaneCount(d)) {
    const auto load = [&](const Plane<float>& plane) { return LoadU(d, plane.row(row.y0) + x); };
    const auto inside = FirstLanes(row.x1 - x, d);
    const VF8 innovation = load(in.innovation);
    const MF8 used = AndNot(IsNaN(innovation), inside);
    const auto add = [&](VF8 value, float* to) {
      Store(Add(Load(d, to + x - row.x0), value), d, to + x - row.x0);
    };
    add(IfThenElseZero(used, innovation), sums.innovation);
    add(ResidualVariance(used, load(in.variance), load(in.samples), load(in.age)), sums.noise);
    add(IfThenElseZero(used, Set(d, 1.0f)), sums.count);
  }
}

// The sum over the columns of one block.
double SumBlock(const float* columns) {
  const F8 d;
  double sum = 0.0;
  for (int i = 0; i < kResidualBlock; i += LaneCount(d)) {
    sum += SumLanes(Load(d, columns + i), d);
  }
  return sum;
}

ResidualBlock TestBlock(const ColumnSums& sums, int column) {
  ResidualBlock block;
  block.confirmed = static_cast<int>(SumBlock(sums.count + column));
  block.is_asked = block.confirmed >= kBlockPixels;
  if (!block.is_asked) return block;
  const double sum = SumBlock(sums.innovation + column);
  block.is_significant = sum * sum > kBlockChance * SumBlock(sums.noise + column);
  return block;
}

// Row by row: those of a block are too short for the next one to be foreseen.
void TestBlocks(const CorrectionInputs& in, const Rect& area, std::span<ResidualBlock> blocks) {
  std::size_t next = 0;
  for (int x0 = area.x0; x0 < area.x1; x0 += ColumnSums::kColumns) {
    const int x1 = std::min(x0 + ColumnSums::kColumns, area.x1);
    ColumnSums sums{};
    for (int y = area.y0; y < area.y1; ++y) AddRow(in, {x0, y, x1, y + 1}, sums);
    for (int x = x0; x < x1; x += kResidualBlock) blocks[next++] = TestBlock(sums, x - x0);
  }
}

// The pixels of a vector of cells: upper left, upper right, lower left, lower right.
template <typename T>
struct Quad {
  T at[4];
};

// Where the quads of a vector of cells lie.
struct Place {
  int column;     // first pixel column
  int rows[2];    // the same row twice where the image ends
  MF8 inside_x;   // the right column is in the image
  bool inside_y;  // and the lower row
};

template <typename D, typename T>
Quad<hn::Vec<D>> LoadQuad(D d, const Plane<T>& plane, const Place& place) {
  Quad<hn::Vec<D>> quad;
  for (std::size_t row = 0; row < 2; ++row) {
    const auto* from = reinterpret_cast<const hn::TFromD<D>*>(plane.row(place.rows[row]));
    hn::LoadInterleaved2(d, from + place.column, quad.at[2 * row], quad.at[2 * row + 1]);
  }
  return quad;
}

void PlaceCellVector(const GBuffer& from, const Place& place, ResidualCells& cells, int x, int y) {
  const F8 d;
  const hn::RebindToSigned<F8> di;
  const hn::RebindToUnsigned<F8> du;
  const VF8 normal_cosine = Set(d, cells.taps.normal_cosine);
  GBuffer& to = cells.guides.surface;
  VF8 cosine[4] = {Zero(d), Zero(d), Zero(d), Zero(d)};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto normal = LoadQuad(d, from.normal[c], place);
    for (int q = 0; q < 4; ++q) cosine[q] = MulAdd(normal.at[0], normal.at[q], cosine[q]);
    StoreU(normal.at[0], d, to.normal[c].row(y) + x);
  }
  StoreU(LoadQuad(d, from.depth, place).at[0], d, to.depth.row(y) + x);
  const auto id = LoadQuad(du, from.id, place);
  StoreU(id.at[0], du, to.id.row(y) + x);
  auto members = Set(di, 1);
  for (int q = 1; q < 4; ++q) {
    if (q > 1 && !place.inside_y) break;
    MF8 same = And(RebindMask(d, Eq(id.at[q], id.at[0])), Ge(cosine[q], normal_cosine));
    if ((q & 1) != 0) same = And(same, place.inside_x);
    members = Or(members, IfThenElseZero(RebindMask(di, same), Set(di, 1 << q)));
  }
  const hn::Rebind<std::uint8_t, F8> bytes;
  StoreU(hn::DemoteTo(bytes, members), bytes, cells.members.row(y) + x);
}

// The members that are confirmed.
Quad<MF8> Confirmed(const CorrectionInputs& in, const Place& place, const ResidualCells& cells,
                    int x, int y) {
  const F8 d;
  const hn::RebindToSigned<F8> di;
  const hn::Rebind<std::uint8_t, F8> bytes;
  const auto members = hn::PromoteTo(di, LoadU(bytes, cells.members.row(y) + x));
  const auto innovation = LoadQuad(d, in.innovation, place);
  Quad<MF8> confirmed;
  for (int q = 0; q < 4; ++q) {
    const auto is_member = hn::TestBit(members, Set(di, 1 << q));
    confirmed.at[q] = AndNot(IsNaN(innovation.at[q]), RebindMask(d, is_member));
  }
  return confirmed;
}

// The filter knows by its depth that a cell has nothing to give.
void DropEmpty(VF8 count, GBuffer& surface, int x, int y) {
  const F8 d;
  const hn::RebindToUnsigned<F8> du;
  const MF8 empty = Eq(count, Zero(d));
  if (AllFalse(d, empty)) return;
  float* const depth = surface.depth.row(y) + x;
  const VF8 infinite = Set(d, std::numeric_limits<float>::infinity());
  StoreU(IfThenElse(empty, infinite, LoadU(d, depth)), d, depth);
  std::uint32_t* const id = surface.id.row(y) + x;
  StoreU(IfThenZeroElse(RebindMask(du, empty), LoadU(du, id)), du, id);
}

void LoadCellVector(const CorrectionInputs& in, const Place& place, ResidualCells& cells, int x,
                    int y) {
  const F8 d;
  const Quad<MF8> member = Confirmed(in, place, cells, x, y);
  VF8 count = Zero(d), noise = Zero(d);
  const auto variance = LoadQuad(d, in.variance, place);
  const auto samples = LoadQuad(d, in.samples, place);
  const auto age = LoadQuad(d, in.age, place);
  for (int q = 0; q < 4; ++q) {
    count = Add(count, IfThenElseZero(member.at[q], Set(d, 1.0f)));
    noise = Add(noise, ResidualVariance(member.at[q], variance.at[q], samples.at[q], age.at[q]));
  }
  const VF8 share = Div(Set(d, 1.0f), Max(count, Set(d, 1.0f)));
  for (std::size_t c = 0; c < 3; ++c) {
    const auto residual = LoadQuad(d, in.residual[c], place);
    VF8 sum = Zero(d);
    for (int q = 0; q < 4; ++q) {
      sum = Add(sum, IfThenElseZero(member.at[q], residual.at[q]));
    }
    StoreU(Mul(sum, share), d, cells.mean[c].row(y) + x);
  }
  StoreU(Mul(noise, Mul(share, share)), d, cells.noise.row(y) + x);
  StoreU(count, d, cells.count.row(y) + x);
  DropEmpty(count, cells.guides.surface, x, y);
}

// Calls visit(place, x, y) for each vector of the cells of `tile`.
template <typename Visit>
void ForEachCells(const Rect& tile, Extent pixels, const Visit& visit) {
  const F8 d;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const bool inside_y = 2 * y + 1 < pixels.height;
    for (int x = tile.x0; x < tile.x1; x += LaneCount(d)) {
      // Of the cells from x on, those with a right column in the image.
      const MF8 whole = FirstLanes(std::max(pixels.width / 2 - x, 0), d);
      visit(Place{2 * x, {2 * y, inside_y ? 2 * y + 1 : 2 * y}, whole, inside_y}, x, y);
    }
  }
}

void PlaceCells(const GBuffer& surface, const Rect& tile, ResidualCells& cells) {
  ForEachCells(tile, surface.depth.extent(), [&](const Place& place, int x, int y) {
    PlaceCellVector(surface, place, cells, x, y);
  });
}

void LoadCells(const CorrectionInputs& in, const Rect& tile, ResidualCells& cells) {
  ForEachCells(tile, in.guides.extent(),
               [&](const Place& place, int x, int y) { LoadCellVector(in, place, cells, x, y); });
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(TestBlocks);
HWY_EXPORT(PlaceCells);
HWY_EXPORT(LoadCells);

void test_blocks(const CorrectionInputs& in, const Rect& area, std::span<ResidualBlock> blocks) {
  EL_DCHECK(area.y1 - area.y0 <= kResidualBlock);
  EL_DCHECK(area.x0 % kResidualBlock == 0 && area.y0 % kResidualBlock == 0);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(TestBlocks)(in, area, blocks);
}

void place_cells(const GBuffer& surface, const Rect& tile, ResidualCells& cells) {
  EL_DCHECK(tile.x0 % kCellStep == 0);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(PlaceCells)(surface, tile, cells);
}

void load_cells(const CorrectionInputs& in, const Rect& tile, ResidualCells& cells) {
  EL_DCHECK(tile.x0 % kCellStep == 0);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadCells)(in, tile, cells);
}

ResidualCells::ResidualCells(Extent pixels, const TapOptions& same_surface)
    : taps(same_surface),
      mean(make_planes<3>({(pixels.width + 1) / 2, (pixels.height + 1) / 2})),
      noise(mean[0].extent()),
      count(mean[0].extent()),
      members(mean[0].extent()) {
  guides.surface.resize(mean[0].extent());
}

void ResidualCells::set_camera(const Camera& camera) {
  guides.camera = camera;
  guides.camera.focal *= 0.5f;
  guides.camera.center = camera.center * 0.5f + 0.25f;
}

}  // namespace eigenlight
#endif
