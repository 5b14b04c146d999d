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

struct BlockSums {
  double residual = 0.0, noise = 0.0, count = 0.0;
};

BlockSums SumBlock(const CorrectionInputs& in, const Plane<float>& residual, const Tile& block) {
  const B d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  BlockSums sums;
  for (int x = block.x0; x < block.x1; x += lanes) {
    VB mean = hn::Zero(d), noise = hn::Zero(d), count = hn::Zero(d);
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(block.x1 - x));
    for (int y = block.y0; y < block.y1; ++y) {
      const auto load = [&](const Plane<float>& plane) {
        prefetch_below(plane, x, y);
        return hn::LoadU(d, plane.row(y) + x);
      };
      const MB used = hn::And(inside, hn::Gt(load(in.confirmed), hn::Zero(d)));
      mean = hn::Add(mean, hn::IfThenElseZero(used, load(residual)));
      noise =
          hn::Add(noise, ResidualVariance(used, load(in.variance), load(in.samples), load(in.age)));
      count = hn::Add(count, hn::IfThenElseZero(used, hn::Set(d, 1.0f)));
    }
    const auto total = [&](VB v) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v))); };
    sums.residual += total(mean);
    sums.noise += total(noise);
    sums.count += total(count);
  }
  return sums;
}

BlockCounts TestBlocks(const CorrectionInputs& in, const Plane<float>& residual, const Tile& tile) {
  BlockCounts counts;
  for (int y = tile.y0; y < tile.y1; y += kBlock) {
    for (int x = tile.x0; x < tile.x1; x += kBlock) {
      const BlockSums sums = SumBlock(
          in, residual,
          {x, y, std::min(x + kBlock, tile.x1), std::min(y + kBlock, tile.y1), tile.index});
      counts.confirmed += static_cast<std::int64_t>(sums.count);
      if (sums.count < kBlockPixels) continue;
      ++counts.all;
      counts.significant += sums.residual * sums.residual > kBlockChance * sums.noise ? 1 : 0;
    }
  }
  return counts;
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
    if (place.rows[row] + 2 < plane.height()) {
      hwy::Prefetch(plane.row(place.rows[row] + 2) + place.column);
    }
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

Taker LoadTaker(const View& view, const Frame& frame, const TapOptions& taps, int x, int y) {
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

void TakeCells(const View& view, float normal_cosine, VI x, int y, float kernel, Taker& taker) {
  const F d;
  const GBuffer& surface = view.cells.guides.surface;
  const auto gather = [&](const Plane<float>& plane) {
    return hn::GatherIndex(d, plane.row(y), x);
  };
  const VI id = hn::GatherIndex(I(), reinterpret_cast<const std::int32_t*>(surface.id.row(y)), x);
  const VF half = hn::Set(d, 0.5f);
  const VF along = view.Along(taker.view_normal, hn::Add(hn::ConvertTo(d, x), half),
                              hn::Set(d, static_cast<float>(y) + 0.5f));
  const VF distance = hn::Abs(hn::MulSub(gather(surface.depth), along, taker.plane));
  VF cosine = hn::Mul(taker.normal[0], gather(surface.normal[0]));
  cosine = hn::MulAdd(taker.normal[1], gather(surface.normal[1]), cosine);
  cosine = hn::MulAdd(taker.normal[2], gather(surface.normal[2]), cosine);
  const auto same =
      hn::And(hn::Le(distance, taker.tolerance), hn::Ge(cosine, hn::Set(d, normal_cosine)));
  const VF weight = hn::IfThenElseZero(
      hn::RebindMask(d, hn::Eq(id, taker.id)),
      hn::IfThenElse(same, hn::Set(d, kernel), hn::Set(d, kOtherSurface * kernel)));
  for (std::size_t c = 0; c < 3; ++c) {
    taker.sum[c] = hn::MulAdd(weight, gather(view.cells.mean[c]), taker.sum[c]);
  }
  taker.weight = hn::Add(taker.weight, weight);
}

void GiveTaker(const Taker& taker, const Plane<float>& confirmed, int x, int y,
               const SpreadOutputs& out) {
  const F d;
  const auto takes = hn::And(hn::Gt(taker.weight, hn::Zero(d)),
                             hn::Gt(hn::LoadU(d, confirmed.row(y) + x), hn::Zero(d)));
  const VF one = hn::Set(d, 1.0f);
  const VF scale =
      hn::IfThenElseZero(takes, hn::Div(one, hn::IfThenElse(takes, taker.weight, one)));
  VF given[3];
  for (std::size_t c = 0; c < 3; ++c) {
    prefetch_below(out.correction[c], x, y);
    prefetch_below(out.prediction[c], x, y);
    given[c] = hn::Mul(taker.sum[c], scale);
    hn::StoreU(given[c], d, out.correction[c].row(y) + x);
    float* prediction = out.prediction[c].row(y) + x;
    hn::StoreU(hn::Add(hn::LoadU(d, prediction), given[c]), d, prediction);
  }
  prefetch_below(confirmed, x, y);
  prefetch_below(out.residual, x, y);
  const VF luminance =
      hn::MulAdd(hn::Set(d, 0.2126f), given[0],
                 hn::MulAdd(hn::Set(d, 0.7152f), given[1], hn::Mul(hn::Set(d, 0.0722f), given[2])));
  float* residual = out.residual.row(y) + x;
  hn::StoreU(hn::Sub(hn::LoadU(d, residual), luminance), d, residual);
}

// A pixel's own cell weighs 3/4 along each axis, the one beyond its nearer edge 1/4.
void SpreadCells(const ResidualCells& cells, const CorrectionInputs& in, const Tile& tile,
                 const SpreadOutputs& out) {
  const F d;
  const I di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const View view{cells, cells.guides.camera};
  const Extent extent = cells.extent();
  const VI last = hn::Set(di, extent.width - 1), zero = hn::Zero(di), one = hn::Set(di, 1);
  const TapOptions taps;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const int own = y / 2, other = std::clamp(own + 2 * (y & 1) - 1, 0, extent.height - 1);
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      Taker taker = LoadTaker(view, in.guides, taps, x, y);
      const VI column = hn::Iota(di, x);
      const VI near = hn::Min(hn::ShiftRight<1>(column), last);
      const VI odd = hn::And(column, one);
      const VI far = hn::Min(hn::Max(hn::Add(near, hn::Sub(hn::Add(odd, odd), one)), zero), last);
      TakeCells(view, taps.normal_cosine, near, own, 9.0f / 16, taker);
      TakeCells(view, taps.normal_cosine, far, own, 3.0f / 16, taker);
      TakeCells(view, taps.normal_cosine, near, other, 3.0f / 16, taker);
      TakeCells(view, taps.normal_cosine, far, other, 1.0f / 16, taker);
      GiveTaker(taker, in.confirmed, x, y, out);
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
HWY_EXPORT(SpreadCells);

BlockCounts test_blocks(const CorrectionInputs& in, const Plane<float>& residual,
                        const Tile& tile) {
  return HWY_DYNAMIC_DISPATCH(TestBlocks)(in, residual, tile);
}

void load_cells(const CorrectionInputs& in, const Planes<3>& prediction, const Tile& tile,
                ResidualCells& cells) {
  HWY_DYNAMIC_DISPATCH(LoadCells)(in, prediction, tile, cells);
}

void spread_cells(const ResidualCells& cells, const CorrectionInputs& in, const Tile& tile,
                  const SpreadOutputs& out) {
  HWY_DYNAMIC_DISPATCH(SpreadCells)(cells, in, tile, out);
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
