#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_filter_simd.cpp"
// Not in alphabetical order: foreach_target.h has to come first.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;
using Scratch = GuidedScratch;

int Lanes() { return static_cast<int>(hn::Lanes(F())); }

// Pixels that the windows of a tile hold; their part inside the image is [x0, x1) x [y0, y1).
struct Area {
  int left, top, width, height;
  int x0, x1, y0, y1;
};

Area SeenArea(const Tile& tile, int radius, Extent extent) {
  Area a{};
  a.left = tile.x0 - 2 * radius;
  a.top = tile.y0 - 2 * radius;
  a.width = tile.x1 - tile.x0 + 4 * radius;
  a.height = tile.y1 - tile.y0 + 4 * radius;
  a.x0 = std::max(a.left, 0);
  a.x1 = std::min(a.left + a.width, extent.width);
  a.y0 = std::max(a.top, 0);
  a.y1 = std::min(a.top + a.height, extent.height);
  return a;
}

// One row of a plane, zero outside the image and in the room behind the row.
template <typename T>
void CopyRow(const Plane<T>& plane, const Area& area, int y, float* out) {
  static_assert(sizeof(T) == sizeof(float));
  std::fill_n(out, Scratch::Seen::kStride, 0.0f);
  if (y < area.y0 || y >= area.y1) return;
  std::memcpy(out + (area.x0 - area.left), plane.at(area.x0, y),
              static_cast<std::size_t>(area.x1 - area.x0) * sizeof(float));
}

// Turns a row of raw values into guides, weights and masks; what must not count becomes 0.
void MaskRow(int width, int y, Scratch& s) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const VF zero = hn::Zero(d), largest = hn::Set(d, std::numeric_limits<float>::max());
  const auto finite = [&](VF v) { return hn::Le(hn::Abs(v), largest); };
  for (int x = 0; x < width; x += Lanes()) {
    const auto load = [&](const Scratch::Seen& block) { return hn::Load(d, block.row(y) + x); };
    const auto id = hn::BitCast(du, load(s.surface));
    const VF depth = load(s.guide[3]);
    auto surface = hn::RebindMask(d, hn::Ne(id, hn::Zero(du)));
    surface = hn::And(surface, hn::And(hn::Gt(depth, zero), finite(depth)));
    for (int i = 0; i < 3; ++i) surface = hn::And(surface, finite(load(s.guide[i])));
    const VF weight = load(s.weight);
    auto used = hn::And(surface, hn::And(hn::Gt(weight, zero), finite(weight)));
    for (int c = 0; c < 3; ++c) used = hn::And(used, finite(load(s.weighted_signal[c])));

    const VF log_depth = hn::Log(d, hn::IfThenElse(surface, depth, hn::Set(d, 1.0f)));
    hn::Store(hn::IfThenElseZero(surface, log_depth), d, s.guide[3].row(y) + x);
    for (int i = 0; i < 3; ++i) {
      hn::Store(hn::IfThenElseZero(surface, load(s.guide[i])), d, s.guide[i].row(y) + x);
    }
    for (int c = 0; c < 3; ++c) {
      const VF signal = hn::IfThenElseZero(used, load(s.weighted_signal[c]));
      const VF weighted = hn::Mul(hn::IfThenElseZero(used, weight), signal);
      hn::Store(weighted, d, s.weighted_signal[c].row(y) + x);
    }
    hn::Store(hn::IfThenElseZero(used, weight), d, s.weight.row(y) + x);
    hn::Store(hn::IfThenElseZero(surface, hn::Set(d, 1.0f)), d, s.surface.row(y) + x);
  }
}

void LoadRow(const GuidedInputs& in, const Area& area, int y, Scratch& s) {
  const int from = area.top + y;
  CopyRow(in.guides.surface.id, area, from, s.surface.row(y));
  CopyRow(in.guides.surface.depth, area, from, s.guide[3].row(y));
  CopyRow(in.weight, area, from, s.weight.row(y));
  for (std::size_t c = 0; c < 3; ++c) {
    CopyRow(in.guides.surface.normal[c], area, from, s.guide[c].row(y));
    CopyRow(in.signal[c], area, from, s.weighted_signal[c].row(y));
  }
  MaskRow(area.width, y, s);
}

// Takes the mean over all surfaces of the block off a guide, so that covariances, which are small
// differences of sums, keep their digits in float.
void CenterGuide(const Area& area, int index, Scratch& s) {
  const F d;
  Scratch::Seen& guide = s.guide[index];
  Scratch::Seen& weighted = s.weighted_guide[index];
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < area.height; ++y) {
    VF row_sum = hn::Zero(d), row_count = hn::Zero(d);
    for (int x = 0; x < area.width; x += Lanes()) {
      row_sum = hn::Add(row_sum, hn::Load(d, guide.row(y) + x));
      row_count = hn::Add(row_count, hn::Load(d, s.surface.row(y) + x));
    }
    sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, row_sum)));
    count += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, row_count)));
  }
  const VF mean = hn::Set(d, count > 0.0 ? static_cast<float>(sum / count) : 0.0f);
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; x += Lanes()) {
      const VF surface = hn::Load(d, s.surface.row(y) + x);
      const VF centered = hn::Mul(surface, hn::Sub(hn::Load(d, guide.row(y) + x), mean));
      hn::Store(centered, d, guide.row(y) + x);
      hn::Store(hn::Mul(centered, hn::Load(d, s.weight.row(y) + x)), d, weighted.row(y) + x);
    }
  }
}

// sum[i] = data[i] + data[i + unit] + ... of `terms` terms, for i in [0, count), from partial sums
// of 1, 2, 4, ... terms that replace `data`. Reads (terms - 1) * unit further, and whole vectors.
struct Run {
  int count, unit, terms;
};
void SumRun(const Run& run, float* HWY_RESTRICT data, float* HWY_RESTRICT sum) {
  const F d;
  int done = 0;
  for (int step = 1; step <= run.terms; step *= 2) {
    if ((run.terms & step) != 0) {
      const float* from = data + done * run.unit;
      for (int i = 0; i < run.count; i += Lanes()) {
        const VF before = done == 0 ? hn::Zero(d) : hn::LoadU(d, sum + i);
        hn::StoreU(hn::Add(before, hn::LoadU(d, from + i)), d, sum + i);
      }
      done += step;
    }
    if (2 * step > run.terms) break;
    // Later steps look no further than the last term of the last sum.
    const int count = run.count + (run.terms - 2 * step) * run.unit;
    const float* ahead = data + step * run.unit;
    for (int i = 0; i < count; i += Lanes()) {
      hn::StoreU(hn::Add(hn::LoadU(d, data + i), hn::LoadU(d, ahead + i)), d, data + i);
    }
  }
}

// Sums over all windows that lie in a block, whose row y `load` writes: the result has 2 radius
// fewer rows and columns.
struct BoxSize {
  int width, height, radius;
};
template <class LoadRow, class Block>
void BoxSum(const BoxSize& size, const LoadRow& load, Scratch& s, Block& result) {
  constexpr int kStride = Block::kStride;
  const int terms = 2 * size.radius + 1, columns = size.width - 2 * size.radius;
  float* along = s.sums.data;
  for (int y = 0; y < size.height; ++y) {
    load(y, s.partial.data);
    SumRun({columns, 1, terms}, s.partial.data, along + y * kStride);
  }
  const int rows = size.height - 2 * size.radius;
  SumRun({(rows - 1) * kStride + columns, kStride, terms}, along, result.data);
}

void SumWindows(const Area& area, int radius, Scratch& s) {
  const F d;
  const BoxSize size{area.width, area.height, radius};
  int next = 0;
  const auto plain = [&](const Scratch::Seen& a) {
    const auto load = [&](int y, float* out) {
      std::memcpy(out, a.row(y), Scratch::Seen::kStride * sizeof(float));
    };
    BoxSum(size, load, s, s.window[next++]);
  };
  const auto product = [&](const Scratch::Seen& a, const Scratch::Seen& b) {
    const auto load = [&](int y, float* out) {
      for (int x = 0; x < area.width; x += Lanes()) {
        hn::Store(hn::Mul(hn::Load(d, a.row(y) + x), hn::Load(d, b.row(y) + x)), d, out + x);
      }
    };
    BoxSum(size, load, s, s.window[next++]);
  };
  plain(s.weight);
  for (const auto& weighted : s.weighted_guide) plain(weighted);
  for (const auto& weighted : s.weighted_signal) plain(weighted);
  for (int j = 0; j < kGuides; ++j) {
    for (int i = 0; i <= j; ++i) product(s.weighted_guide[i], s.guide[j]);
  }
  for (int i = 0; i < kGuides; ++i) {
    for (int c = 0; c < 3; ++c) product(s.weighted_signal[c], s.guide[i]);
  }
}

// Cov + diag(epsilon) = L D L^T of a window, in vectors of windows.
struct Factors {
  VF lower[kGuides][kGuides];  // below the diagonal
  VF inverse[kGuides];         // of D
  hn::Mask<F> sound;
};

// In exact arithmetic a pivot is at least epsilon, since Cov is positive semidefinite; half of it
// says that rounding has won.
Factors Factorize(const VF (&covariance)[kGuides][kGuides], const VF (&epsilon)[kGuides]) {
  const F d;
  Factors f;
  f.sound = hn::Eq(hn::Zero(d), hn::Zero(d));
  VF scaled[kGuides][kGuides];  // L D
  for (int j = 0; j < kGuides; ++j) {
    for (int i = 0; i <= j; ++i) {
      VF v = covariance[i][j];
      for (int m = 0; m < i; ++m) v = hn::NegMulAdd(scaled[j][m], f.lower[i][m], v);
      if (i < j) {
        scaled[j][i] = v;
        f.lower[j][i] = hn::Mul(v, f.inverse[i]);
      } else {
        const VF pivot = hn::Add(v, epsilon[j]);
        f.sound = hn::And(f.sound, hn::Gt(pivot, hn::Mul(hn::Set(d, 0.5f), epsilon[j])));
        f.inverse[j] = hn::Div(hn::Set(d, 1.0f), pivot);
      }
    }
  }
  return f;
}

void Solve(const Factors& f, VF (&x)[kGuides]) {
  for (int j = 1; j < kGuides; ++j) {
    for (int i = 0; i < j; ++i) x[j] = hn::NegMulAdd(f.lower[j][i], x[i], x[j]);
  }
  for (int j = 0; j < kGuides; ++j) x[j] = hn::Mul(x[j], f.inverse[j]);
  for (int j = kGuides - 2; j >= 0; --j) {
    for (int i = j + 1; i < kGuides; ++i) x[j] = hn::NegMulAdd(f.lower[i][j], x[i], x[j]);
  }
}

// Offset of a window's first product with the signal among its sums.
constexpr int kSignal = 1 + kGuides;
constexpr int kSquares = kSignal + 3;
constexpr int kProducts = kSquares + kGuides * (kGuides + 1) / 2;

// Fits the windows at `at`; leaves a and b of each channel, then the mask of windows, in the place
// of their sums.
void FitWindows(const VF (&epsilon)[kGuides], VF surface, std::size_t at, Scratch& s) {
  const F d;
  const auto sum = [&](int index) { return hn::Load(d, s.window[index].data + at); };
  const VF weight = sum(0);
  const auto some = hn::And(hn::Gt(weight, hn::Zero(d)), hn::Gt(surface, hn::Zero(d)));
  const VF scale = hn::IfThenElseZero(some, hn::Div(hn::Set(d, 1.0f), weight));
  VF mean[kGuides], covariance[kGuides][kGuides];
  for (int i = 0; i < kGuides; ++i) mean[i] = hn::Mul(scale, sum(1 + i));
  for (int j = 0, index = kSquares; j < kGuides; ++j) {
    for (int i = 0; i <= j; ++i) {
      covariance[i][j] = hn::MulSub(scale, sum(index++), hn::Mul(mean[i], mean[j]));
    }
  }
  const Factors factors = Factorize(covariance, epsilon);
  VF signal[3], slope[3][kGuides];
  for (int c = 0; c < 3; ++c) {
    signal[c] = hn::Mul(scale, sum(kSignal + c));
    for (int i = 0; i < kGuides; ++i) {
      slope[c][i] = hn::MulSub(scale, sum(kProducts + 3 * i + c), hn::Mul(mean[i], signal[c]));
    }
  }
  for (int c = 0; c < 3; ++c) {
    Solve(factors, slope[c]);
    VF offset = signal[c];
    for (int i = 0; i < kGuides; ++i) {
      const VF a = hn::IfThenElseZero(hn::And(some, factors.sound), slope[c][i]);
      offset = hn::NegMulAdd(a, mean[i], offset);
      hn::Store(a, d, s.window[5 * c + i].data + at);
    }
    hn::Store(hn::IfThenElseZero(some, offset), d, s.window[5 * c + kGuides].data + at);
  }
  hn::Store(hn::IfThenElseZero(some, hn::Set(d, 1.0f)), d, s.window[15].data + at);
}

void FitAll(const GuidedOptions& options, const Area& area, Scratch& s) {
  const F d;
  const VF normal = hn::Set(d, options.epsilon_normal);
  const VF epsilon[kGuides] = {normal, normal, normal, hn::Set(d, options.epsilon_depth)};
  const int r = options.radius;
  for (int y = 0; y < area.height - 2 * r; ++y) {
    for (int x = 0; x < area.width - 2 * r; x += Lanes()) {
      const VF surface = hn::LoadU(d, s.surface.row(y + r) + x + r);
      FitWindows(epsilon, surface, static_cast<std::size_t>(y * Scratch::Windows::kStride + x), s);
    }
  }
}

// Averages the coefficients over the windows that hold each pixel, and applies them to its guides.
// The result goes to blocks of sums that the fits have spent.
void Average(const GuidedOptions& options, const Area& area, Scratch& s) {
  const F d;
  const int r = options.radius;
  const BoxSize size{area.width - 2 * r, area.height - 2 * r, r};
  for (int index = 0; index < 16; ++index) {
    const auto load = [&](int y, float* out) {
      std::memcpy(out, s.window[index].row(y), Scratch::Windows::kStride * sizeof(float));
    };
    BoxSum(size, load, s, s.window[index]);
  }
  for (int y = 0; y < area.height - 4 * r; ++y) {
    for (int x = 0; x < area.width - 4 * r; x += Lanes()) {
      const auto at = [&](int index) { return hn::Load(d, s.window[index].row(y) + x); };
      const VF windows = at(15);
      const VF surface = hn::LoadU(d, s.surface.row(y + 2 * r) + x + 2 * r);
      const auto some = hn::And(hn::Gt(windows, hn::Zero(d)), hn::Gt(surface, hn::Zero(d)));
      for (int c = 0; c < 3; ++c) {
        VF v = at(5 * c + kGuides);
        for (int i = 0; i < kGuides; ++i) {
          const VF guide = hn::LoadU(d, s.guide[i].row(y + 2 * r) + x + 2 * r);
          v = hn::MulAdd(at(5 * c + i), guide, v);
        }
        hn::Store(hn::IfThenElseZero(some, hn::Div(v, windows)), d, s.window[16 + c].row(y) + x);
      }
    }
  }
}

void GuidedTile(const GuidedInputs& in, const GuidedOptions& options, const Tile& tile,
                GuidedScratch& s, Planes<3>& out) {
  const Area area = SeenArea(tile, options.radius, in.weight.extent());
  for (int y = 0; y < area.height; ++y) LoadRow(in, area, y, s);
  for (int i = 0; i < kGuides; ++i) CenterGuide(area, i, s);
  SumWindows(area, options.radius, s);
  FitAll(options, area, s);
  Average(options, area, s);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float* from = s.window[16 + c].row(y - tile.y0);
      std::copy(from, from + (tile.x1 - tile.x0), out[c].at(tile.x0, y));
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(GuidedTile);

void guided_tile(const GuidedInputs& in, const GuidedOptions& options, const Tile& tile,
                 GuidedScratch& scratch, Planes<3>& out) {
  HWY_DYNAMIC_DISPATCH(GuidedTile)(in, options, tile, scratch, out);
}

}  // namespace eigenlight
#endif
