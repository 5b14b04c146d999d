#include <algorithm>
#include <limits>

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
constexpr int kBlock = 8, kBlockPixels = 16;

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

  alignas(64) float residual[kColumns], noise[kColumns], count[kColumns];
};

// Adds a row of at most kColumns pixels.
void AddRow(const CorrectionInputs& in, const Plane<float>& residual, const Tile& row,
            ColumnSums& sums) {
  const B d;
  for (int x = row.x0; x < row.x1; x += static_cast<int>(hn::Lanes(d))) {
    const auto load = [&](const Plane<float>& plane) {
      prefetch_below(plane, x, row.y0);
      return hn::LoadU(d, plane.row(row.y0) + x);
    };
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(row.x1 - x));
    const MB used = hn::And(inside, hn::Gt(load(in.confirmed), hn::Zero(d)));
    const auto add = [&](VB value, float* to) {
      hn::Store(hn::Add(hn::Load(d, to + x - row.x0), value), d, to + x - row.x0);
    };
    add(hn::IfThenElseZero(used, load(residual)), sums.residual);
    add(ResidualVariance(used, load(in.variance), load(in.samples), load(in.age)), sums.noise);
    add(hn::IfThenElseZero(used, hn::Set(d, 1.0f)), sums.count);
  }
}

// The sum over the columns of one block.
double SumBlock(const float* columns) {
  const B d;
  double sum = 0.0;
  for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(d))) {
    sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, hn::Load(d, columns + i))));
  }
  return sum;
}

void CountBlock(const ColumnSums& sums, int column, BlockCounts& counts) {
  const double count = SumBlock(sums.count + column);
  counts.confirmed += static_cast<std::int64_t>(count);
  if (count < kBlockPixels) return;
  const double residual = SumBlock(sums.residual + column);
  ++counts.all;
  counts.significant += residual * residual > kBlockChance * SumBlock(sums.noise + column) ? 1 : 0;
}

// Row by row: those of a block are too short for the next one to be foreseen.
void TestBlocks(const CorrectionInputs& in, const Plane<float>& residual, const Tile& area,
                int tile_width, std::span<BlockCounts> counts) {
  for (int y0 = area.y0; y0 < area.y1; y0 += kBlock) {
    for (int x0 = area.x0; x0 < area.x1; x0 += ColumnSums::kColumns) {
      const int x1 = std::min(x0 + ColumnSums::kColumns, area.x1);
      ColumnSums sums{};
      for (int y = y0; y < std::min(y0 + kBlock, area.y1); ++y) {
        AddRow(in, residual, {x0, y, x1, y + 1, 0}, sums);
      }
      for (int x = x0; x < x1; x += kBlock) {
        CountBlock(sums, x - x0, counts[static_cast<std::size_t>((x - area.x0) / tile_width)]);
      }
    }
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
    if (place.inside_y) prefetch_below(plane, place.column, place.rows[row] + 1);
    hn::LoadInterleaved2(d, from + place.column, quad.at[2 * row], quad.at[2 * row + 1]);
  }
  return quad;
}

// Which of the four pixels are confirmed and show the surface of the first.
Quad<MB> Members(const CorrectionInputs& in, const Place& place, const TapOptions& taps,
                 ResidualCells& cells, int x, int y) {
  const B d;
  const hn::RebindToUnsigned<B> du;
  const auto id = LoadQuad(du, in.guides.surface.id, place);
  const auto confirmed = LoadQuad(d, in.confirmed, place);
  VB cosine[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto normal = LoadQuad(d, in.guides.surface.normal[c], place);
    for (int q = 0; q < 4; ++q) cosine[q] = hn::MulAdd(normal.at[0], normal.at[q], cosine[q]);
    hn::StoreU(normal.at[0], d, cells.guides.surface.normal[c].row(y) + x);
  }
  Quad<MB> member;
  auto any = hn::RebindMask(d, hn::Ne(id.at[0], id.at[0]));
  for (int q = 0; q < 4; ++q) {
    member.at[q] = hn::And(hn::RebindMask(d, hn::Eq(id.at[q], id.at[0])),
                           hn::Gt(confirmed.at[q], hn::Zero(d)));
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

void LoadCellVector(const CorrectionInputs& in, const Planes<3>& prediction, const Place& place,
                    ResidualCells& cells, int x, int y) {
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
    const auto light = LoadQuad(d, in.light[c], place);
    const auto expected = LoadQuad(d, prediction[c], place);
    VB sum = hn::Zero(d);
    for (int q = 0; q < 4; ++q) {
      const VB residual = hn::Sub(light.at[q], expected.at[q]);
      sum = hn::Add(sum, hn::IfThenElseZero(member.at[q], residual));
    }
    hn::StoreU(hn::Mul(sum, share), d, cells.mean[c].row(y) + x);
  }
  hn::StoreU(hn::Mul(noise, hn::Mul(share, share)), d, cells.noise.row(y) + x);
  hn::StoreU(count, d, cells.count.row(y) + x);
  // The filter knows by its depth that a cell has nothing to give.
  const VB depth = LoadQuad(d, in.guides.surface.depth, place).at[0];
  const VB infinite = hn::Set(d, std::numeric_limits<float>::infinity());
  hn::StoreU(hn::IfThenElse(hn::Gt(count, hn::Zero(d)), depth, infinite), d,
             cells.guides.surface.depth.row(y) + x);
}

void LoadCells(const CorrectionInputs& in, const Planes<3>& prediction, const Tile& tile,
               ResidualCells& cells) {
  const B d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Extent pixels = in.guides.extent();
  for (int y = tile.y0; y < tile.y1; ++y) {
    const bool inside_y = 2 * y + 1 < pixels.height;
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      // Of the cells from x on, those with a right column in the image.
      const int whole = std::max(pixels.width / 2 - x, 0);
      LoadCellVector(in, prediction,
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

void test_blocks(const CorrectionInputs& in, const Plane<float>& residual, const Tile& area,
                 int tile_width, std::span<BlockCounts> counts) {
  HWY_DYNAMIC_DISPATCH(TestBlocks)(in, residual, area, tile_width, counts);
}

void load_cells(const CorrectionInputs& in, const Planes<3>& prediction, const Tile& tile,
                ResidualCells& cells) {
  HWY_DYNAMIC_DISPATCH(LoadCells)(in, prediction, tile, cells);
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
