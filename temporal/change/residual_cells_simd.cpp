#include <algorithm>
#include <limits>

#include "frame/float_traps.h"
#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/residual_cells_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Squared standard deviations of a block's mean that count as chance: 0.3 % of normal noise, some 2
// % of path-traced noise with its heavy tail; and the pixels a block must have to be asked at all.
constexpr double kBlockChance = 9.0;
constexpr int kBlockPixels = 16;

// Up to eight lanes: a row of a block, or as many cells of which a row of pixels has both columns
// inside its padding.
using B = hn::CappedTag<float, 8>;
using VB = hn::Vec<B>;
using MB = hn::Mask<B>;

// v (1/s + 1/n) where `used`, else 0.
VB ResidualVariance(MB used, VB variance, VB samples, VB age) {
  const B d;
  const VB one = hn::Set(d, 1.0f);
  const VB s = hn::IfThenElse(used, samples, one), n = hn::IfThenElse(used, age, one);
  return hn::IfThenElseZero(used, hn::Mul(variance, hn::Add(hn::Div(one, s), hn::Div(one, n))));
}

// Sums over the rows of some blocks side by side, for each column of pixels.
struct ColumnSums {
  static constexpr int kColumns = 256;

  alignas(64) float innovation[kColumns], noise[kColumns], count[kColumns];
};

// Adds a row of at most kColumns pixels.
void AddRow(const CorrectionInputs& in, const Rect& row, ColumnSums& sums) {
  const B d;
  for (int x = row.x0; x < row.x1; x += static_cast<int>(hn::Lanes(d))) {
    const auto load = [&](const Plane<float>& plane) {
      return hn::LoadU(d, plane.row(row.y0) + x);
    };
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(row.x1 - x));
    const VB innovation = load(in.innovation);
    const MB used = hn::AndNot(hn::IsNaN(innovation), inside);
    const auto add = [&](VB value, float* to) {
      hn::Store(hn::Add(hn::Load(d, to + x - row.x0), value), d, to + x - row.x0);
    };
    add(hn::IfThenElseZero(used, innovation), sums.innovation);
    add(ResidualVariance(used, load(in.variance), load(in.samples), load(in.age)), sums.noise);
    add(hn::IfThenElseZero(used, hn::Set(d, 1.0f)), sums.count);
  }
}

// The sum over the columns of one block.
double SumBlock(const float* columns) {
  const B d;
  double sum = 0.0;
  for (int i = 0; i < kResidualBlock; i += static_cast<int>(hn::Lanes(d))) {
    sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, hn::Load(d, columns + i))));
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
  MB inside_x;    // the right column is in the image
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
  const B d;
  const hn::RebindToSigned<B> di;
  const hn::RebindToUnsigned<B> du;
  const VB normal_cosine = hn::Set(d, cells.taps.normal_cosine);
  GBuffer& to = cells.guides.surface;
  VB cosine[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto normal = LoadQuad(d, from.normal[c], place);
    for (int q = 0; q < 4; ++q) cosine[q] = hn::MulAdd(normal.at[0], normal.at[q], cosine[q]);
    hn::StoreU(normal.at[0], d, to.normal[c].row(y) + x);
  }
  hn::StoreU(LoadQuad(d, from.depth, place).at[0], d, to.depth.row(y) + x);
  const auto id = LoadQuad(du, from.id, place);
  hn::StoreU(id.at[0], du, to.id.row(y) + x);
  auto members = hn::Set(di, 1);
  for (int q = 1; q < 4; ++q) {
    if (q > 1 && !place.inside_y) break;
    MB same =
        hn::And(hn::RebindMask(d, hn::Eq(id.at[q], id.at[0])), hn::Ge(cosine[q], normal_cosine));
    if ((q & 1) != 0) same = hn::And(same, place.inside_x);
    members = hn::Or(members, hn::IfThenElseZero(hn::RebindMask(di, same), hn::Set(di, 1 << q)));
  }
  const hn::Rebind<std::uint8_t, B> bytes;
  hn::StoreU(hn::DemoteTo(bytes, members), bytes, cells.members.row(y) + x);
}

// The members that are confirmed.
Quad<MB> Confirmed(const CorrectionInputs& in, const Place& place, const ResidualCells& cells,
                   int x, int y) {
  const B d;
  const hn::RebindToSigned<B> di;
  const hn::Rebind<std::uint8_t, B> bytes;
  const auto members = hn::PromoteTo(di, hn::LoadU(bytes, cells.members.row(y) + x));
  const auto innovation = LoadQuad(d, in.innovation, place);
  Quad<MB> confirmed;
  for (int q = 0; q < 4; ++q) {
    const auto is_member = hn::TestBit(members, hn::Set(di, 1 << q));
    confirmed.at[q] = hn::AndNot(hn::IsNaN(innovation.at[q]), hn::RebindMask(d, is_member));
  }
  return confirmed;
}

// The filter knows by its depth that a cell has nothing to give.
void DropEmpty(VB count, GBuffer& surface, int x, int y) {
  const B d;
  const hn::RebindToUnsigned<B> du;
  const MB empty = hn::Eq(count, hn::Zero(d));
  if (hn::AllFalse(d, empty)) return;
  float* const depth = surface.depth.row(y) + x;
  const VB infinite = hn::Set(d, std::numeric_limits<float>::infinity());
  hn::StoreU(hn::IfThenElse(empty, infinite, hn::LoadU(d, depth)), d, depth);
  std::uint32_t* const id = surface.id.row(y) + x;
  hn::StoreU(hn::IfThenZeroElse(hn::RebindMask(du, empty), hn::LoadU(du, id)), du, id);
}

void LoadCellVector(const CorrectionInputs& in, const Place& place, ResidualCells& cells, int x,
                    int y) {
  const B d;
  const Quad<MB> member = Confirmed(in, place, cells, x, y);
  VB count = hn::Zero(d), noise = hn::Zero(d);
  const auto variance = LoadQuad(d, in.variance, place);
  const auto samples = LoadQuad(d, in.samples, place);
  const auto age = LoadQuad(d, in.age, place);
  for (int q = 0; q < 4; ++q) {
    count = hn::Add(count, hn::IfThenElseZero(member.at[q], hn::Set(d, 1.0f)));
    noise =
        hn::Add(noise, ResidualVariance(member.at[q], variance.at[q], samples.at[q], age.at[q]));
  }
  const VB share = hn::Div(hn::Set(d, 1.0f), hn::Max(count, hn::Set(d, 1.0f)));
  for (std::size_t c = 0; c < 3; ++c) {
    const auto residual = LoadQuad(d, in.residual[c], place);
    VB sum = hn::Zero(d);
    for (int q = 0; q < 4; ++q) {
      sum = hn::Add(sum, hn::IfThenElseZero(member.at[q], residual.at[q]));
    }
    hn::StoreU(hn::Mul(sum, share), d, cells.mean[c].row(y) + x);
  }
  hn::StoreU(hn::Mul(noise, hn::Mul(share, share)), d, cells.noise.row(y) + x);
  hn::StoreU(count, d, cells.count.row(y) + x);
  DropEmpty(count, cells.guides.surface, x, y);
}

// Calls visit(place, x, y) for each vector of the cells of `tile`.
template <typename Visit>
void ForEachVector(const Rect& tile, Extent pixels, const Visit& visit) {
  const B d;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const bool inside_y = 2 * y + 1 < pixels.height;
    for (int x = tile.x0; x < tile.x1; x += static_cast<int>(hn::Lanes(d))) {
      // Of the cells from x on, those with a right column in the image.
      const auto whole = static_cast<std::size_t>(std::max(pixels.width / 2 - x, 0));
      visit(Place{2 * x, {2 * y, inside_y ? 2 * y + 1 : 2 * y}, hn::FirstN(d, whole), inside_y}, x,
            y);
    }
  }
}

void PlaceCells(const GBuffer& surface, const Rect& tile, ResidualCells& cells) {
  ForEachVector(tile, surface.depth.extent(), [&](const Place& place, int x, int y) {
    PlaceCellVector(surface, place, cells, x, y);
  });
}

void LoadCells(const CorrectionInputs& in, const Rect& tile, ResidualCells& cells) {
  ForEachVector(tile, in.guides.extent(),
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
