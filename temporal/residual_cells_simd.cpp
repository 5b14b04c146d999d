#include <algorithm>
#include <limits>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "reproject/taps.h"
#include "temporal/residual_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/residual_cells_simd.cpp"
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
void AddRow(const CorrectionInputs& in, const Tile& row, ColumnSums& sums) {
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
void TestBlocks(const CorrectionInputs& in, const Tile& area, std::span<ResidualBlock> blocks) {
  std::size_t next = 0;
  for (int x0 = area.x0; x0 < area.x1; x0 += ColumnSums::kColumns) {
    const int x1 = std::min(x0 + ColumnSums::kColumns, area.x1);
    ColumnSums sums{};
    for (int y = area.y0; y < area.y1; ++y) AddRow(in, {x0, y, x1, y + 1, 0}, sums);
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

// Ask for what the next row of cells will read of its surfaces, which nothing before it has read.
void PrefetchSurfaces(const GBuffer& surface, const Place& place) {
  if (!place.inside_y) return;
  for (const int row : {place.rows[0] + 1, place.rows[1] + 1}) {
    for (const auto& plane : surface.normal) prefetch_below(plane, place.column, row);
    prefetch_below(surface.id, place.column, row);
  }
  prefetch_below(surface.depth, place.column, place.rows[0] + 1);
}

// Which of the four pixels are confirmed and show the surface of the first.
Quad<MB> Members(const CorrectionInputs& in, const Place& place, const TapOptions& taps,
                 ResidualCells& cells, int x, int y) {
  const B d;
  const hn::RebindToUnsigned<B> du;
  PrefetchSurfaces(in.guides.surface, place);
  const auto id = LoadQuad(du, in.guides.surface.id, place);
  const auto innovation = LoadQuad(d, in.innovation, place);
  VB cosine[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto normal = LoadQuad(d, in.guides.surface.normal[c], place);
    for (int q = 0; q < 4; ++q) cosine[q] = hn::MulAdd(normal.at[0], normal.at[q], cosine[q]);
    hn::StoreU(normal.at[0], d, cells.guides.surface.normal[c].row(y) + x);
  }
  Quad<MB> member;
  auto any = hn::RebindMask(d, hn::Ne(id.at[0], id.at[0]));
  for (int q = 0; q < 4; ++q) {
    member.at[q] =
        hn::AndNot(hn::IsNaN(innovation.at[q]), hn::RebindMask(d, hn::Eq(id.at[q], id.at[0])));
    if (q > 0) {
      member.at[q] = hn::And(member.at[q], hn::Ge(cosine[q], hn::Set(d, taps.normal_cosine)));
    }
    if ((q & 1) != 0) member.at[q] = hn::And(member.at[q], place.inside_x);
    if (q > 1 && !place.inside_y) member.at[q] = hn::RebindMask(d, hn::Ne(id.at[0], id.at[0]));
    any = hn::Or(any, member.at[q]);
  }
  hn::StoreU(hn::IfThenElseZero(hn::RebindMask(du, any), id.at[0]), du,
             cells.guides.surface.id.row(y) + x);
  return member;
}

void LoadCellVector(const CorrectionInputs& in, const Place& place, ResidualCells& cells, int x,
                    int y) {
  const B d;
  const Quad<MB> member = Members(in, place, {}, cells, x, y);
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
  // The filter knows by its depth that a cell has nothing to give.
  VB depth, beside;
  hn::LoadInterleaved2(d, in.guides.surface.depth.row(place.rows[0]) + place.column, depth, beside);
  const VB infinite = hn::Set(d, std::numeric_limits<float>::infinity());
  hn::StoreU(hn::IfThenElse(hn::Gt(count, hn::Zero(d)), depth, infinite), d,
             cells.guides.surface.depth.row(y) + x);
}

void LoadCells(const CorrectionInputs& in, const Tile& tile, ResidualCells& cells) {
  const B d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Extent pixels = in.guides.extent();
  for (int y = tile.y0; y < tile.y1; ++y) {
    const bool inside_y = 2 * y + 1 < pixels.height;
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      // Of the cells from x on, those with a right column in the image.
      const int whole = std::max(pixels.width / 2 - x, 0);
      LoadCellVector(in,
                     {2 * x,
                      {2 * y, inside_y ? 2 * y + 1 : 2 * y},
                      hn::FirstN(d, static_cast<std::size_t>(whole)),
                      inside_y},
                     cells, x, y);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(TestBlocks);
HWY_EXPORT(LoadCells);

void test_blocks(const CorrectionInputs& in, const Tile& area, std::span<ResidualBlock> blocks) {
  EL_DCHECK(area.y1 - area.y0 <= kResidualBlock);
  EL_DCHECK(area.x0 % kResidualBlock == 0 && area.y0 % kResidualBlock == 0);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(TestBlocks)(in, area, blocks);
}

void load_cells(const CorrectionInputs& in, const Tile& tile, ResidualCells& cells) {
  EL_DCHECK(tile.x0 % kCellStep == 0);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadCells)(in, tile, cells);
}

ResidualCells::ResidualCells(Extent pixels)
    : mean(make_planes<3>({(pixels.width + 1) / 2, (pixels.height + 1) / 2})),
      noise(mean[0].extent()),
      count(mean[0].extent()) {
  guides.surface.resize(mean[0].extent());
}

void ResidualCells::set_camera(const Camera& camera) {
  guides.camera = camera;
  guides.camera.focal *= 0.5f;
  guides.camera.center = camera.center * 0.5f + 0.25f;
}

}  // namespace eigenlight
#endif
