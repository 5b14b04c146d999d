#include <algorithm>

#include "frame/float_traps.h"
#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_filter_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;

int Lanes() { return static_cast<int>(hn::Lanes(F())); }

// sum[i] = data[i] + data[i + 1] + ... of `terms` terms, for i in [0, count), from partial sums of
// 1, 2, 4, ... terms that replace `data`. Reads whole vectors.
void SumAlong(int count, int terms, float* HWY_RESTRICT data, float* HWY_RESTRICT sum) {
  const F d;
  int done = 0;
  for (int step = 1; step <= terms; step *= 2) {
    if ((terms & step) != 0) {
      const float* from = data + done;
      for (int i = 0; i < count; i += Lanes()) {
        const VF before = done == 0 ? hn::Zero(d) : hn::LoadU(d, sum + i);
        hn::StoreU(hn::Add(before, hn::LoadU(d, from + i)), d, sum + i);
      }
      done += step;
    }
    if (2 * step > terms) break;
    // Later steps look no further than the last term of the last sum.
    const int reach = count + terms - 2 * step;
    for (int i = 0; i < reach; i += Lanes()) {
      hn::StoreU(hn::Add(hn::LoadU(d, data + i), hn::LoadU(d, data + i + step)), d, data + i);
    }
  }
}

void Restart(ColumnSums& sums) {
  sums.slots.fill(0.0f);
  sums.prefix.fill(0.0f);
}

// Takes a row of one quantity in; leaves the sums over the last `terms` rows in sums.sum.
void Push(int quantity, int slot, int count, const float* HWY_RESTRICT row, ColumnSums& sums) {
  const F d;
  float* HWY_RESTRICT here = sums.slots.row(slot * sums.quantities + quantity);
  float* HWY_RESTRICT prefix = sums.prefix.row(quantity);
  float* HWY_RESTRICT sum = sums.sum.row(quantity);
  const bool is_last = slot + 1 == sums.terms;
  const float* rest = is_last ? here : sums.slots.row((slot + 1) * sums.quantities + quantity);
  for (int x = 0; x < count; x += Lanes()) {
    const VF value = hn::Load(d, row + x);
    const VF so_far = slot == 0 ? value : hn::Add(hn::Load(d, prefix + x), value);
    hn::Store(so_far, d, prefix + x);
    hn::Store(is_last ? so_far : hn::Add(so_far, hn::Load(d, rest + x)), d, sum + x);
    hn::Store(value, d, here + x);
  }
}

// At the end of a block: turns its rows into sums of each row and those that follow it.
void Finish(int slot, ColumnSums& sums) {
  if (slot + 1 < sums.terms) return;
  const F d;
  const auto count = static_cast<int>(sums.slots.stride()) * sums.quantities;
  for (int i = sums.terms - 2; i >= 0; --i) {
    float* HWY_RESTRICT here = sums.slots.row(i * sums.quantities);
    const float* HWY_RESTRICT next = sums.slots.row((i + 1) * sums.quantities);
    for (int x = 0; x < count; x += Lanes()) {
      hn::Store(hn::Add(hn::Load(d, here + x), hn::Load(d, next + x)), d, here + x);
    }
  }
}

// The filter with kN guides.
template <int kN>
class Filter {
 public:
  Filter(const GuidedWork& work, const Tile& run, GuidedScratch& scratch)
      : work_(work), run_(run), s_(scratch), r_(work.options.radius) {
    for (int i = 0; i < kN; ++i) {
      epsilon_[i] = i < 3 ? work.options.epsilon_normal : work.options.epsilon_depth;
    }
  }

  void Run(Planes<3>& out) {
    Restart(s_.windows);
    Restart(s_.fits);
    const int width = run_.x1 - run_.x0, height = work_.in.weight.height();
    // Rows above the image are the zeros that the sums start from; those below it are pushed.
    for (int y = std::max(run_.y0 - 2 * r_, 0); y < run_.y1 + 2 * r_; ++y) {
      if (y < height) {
        guided_load_row(work_, {run_.x0 - 2 * r_, width + 4 * r_}, y, s_);
        SumWindows(y, width + 2 * r_);
      } else {
        PushZeros(y, width + 2 * r_, s_.windows);
      }
      const int fitted = y - r_;
      if (fitted < std::max(run_.y0 - r_, 0)) continue;
      if (fitted < height) {
        FitRow(fitted, width + 2 * r_);
        SumFits(fitted, width);
      } else {
        PushZeros(fitted, width, s_.fits);
      }
      if (y - 2 * r_ >= run_.y0) Apply(y - 2 * r_, width, out);
    }
  }

 private:
  // Offset of a window's first sum of w N_c, w I_i I_j, w I_i N_c.
  static constexpr int kSignal = 1 + kN;
  static constexpr int kSquares = kSignal + 3;
  static constexpr int kProducts = kSquares + kN * (kN + 1) / 2;

  const float* Guide(int index, int y) const {
    return s_.guides.row(block_slot(y, s_.windows.terms) * (kN + 1) + index);
  }

  void SumWindows(int y, int count) {
    const F d;
    const int seen = count + 2 * r_, slot = block_slot(y, s_.windows.terms);
    int next = 0;
    const auto sum = [&](const auto& value) {
      float* row = s_.partial.row(0);
      for (int x = 0; x < seen; x += Lanes()) hn::Store(value(x), d, row + x);
      SumAlong(count, s_.windows.terms, row, s_.along.row(0));
      Push(next++, slot, count, s_.along.row(0), s_.windows);
    };
    const auto plain = [&](const float* a) { sum([=](int x) { return hn::Load(F(), a + x); }); };
    const auto product = [&](const float* a, const float* b) {
      sum([=](int x) { return hn::Mul(hn::Load(F(), a + x), hn::Load(F(), b + x)); });
    };
    plain(s_.row.weight.row(0));
    for (int i = 0; i < kN; ++i) plain(s_.weighted_guide.row(i));
    for (const auto& plane : s_.row.signal) plain(plane.row(0));
    for (int j = 0; j < kN; ++j) {
      for (int i = 0; i <= j; ++i) product(s_.weighted_guide.row(i), Guide(j, y));
    }
    for (int i = 0; i < kN; ++i) {
      for (const auto& plane : s_.row.signal) product(plane.row(0), Guide(i, y));
    }
    Finish(slot, s_.windows);
  }

  void PushZeros(int y, int count, ColumnSums& sums) {
    const int slot = block_slot(y, sums.terms);
    s_.along.fill(0.0f);
    for (int q = 0; q < sums.quantities; ++q) Push(q, slot, count, s_.along.row(0), sums);
    Finish(slot, sums);
  }

  // Cov + diag(epsilon) = L D L^T of a window, in vectors of windows.
  struct Factors {
    VF lower[kN][kN];  // below the diagonal
    VF inverse[kN];    // of D
    hn::Mask<F> sound;
  };

  // In exact arithmetic a pivot is at least epsilon, since Cov is positive semidefinite; half of
  // it says that rounding has won.
  Factors Factorize(const VF (&covariance)[kN][kN]) const {
    const F d;
    Factors f;
    f.sound = hn::Eq(hn::Zero(d), hn::Zero(d));
    VF scaled[kN][kN];  // L D
    for (int j = 0; j < kN; ++j) {
      for (int i = 0; i <= j; ++i) {
        VF v = covariance[i][j];
        for (int m = 0; m < i; ++m) v = hn::NegMulAdd(scaled[j][m], f.lower[i][m], v);
        if (i < j) {
          scaled[j][i] = v;
          f.lower[j][i] = hn::Mul(v, f.inverse[i]);
        } else {
          const VF pivot = hn::Add(v, hn::Set(d, epsilon_[j]));
          f.sound = hn::And(f.sound, hn::Gt(pivot, hn::Set(d, 0.5f * epsilon_[j])));
          f.inverse[j] = hn::Div(hn::Set(d, 1.0f), pivot);
        }
      }
    }
    return f;
  }

  static void Solve(const Factors& f, VF (&x)[kN]) {
    for (int j = 1; j < kN; ++j) {
      for (int i = 0; i < j; ++i) x[j] = hn::NegMulAdd(f.lower[j][i], x[i], x[j]);
    }
    for (int j = 0; j < kN; ++j) x[j] = hn::Mul(x[j], f.inverse[j]);
    for (int j = kN - 2; j >= 0; --j) {
      for (int i = j + 1; i < kN; ++i) x[j] = hn::NegMulAdd(f.lower[i][j], x[i], x[j]);
    }
  }

  // Fits the windows around the pixels of row y.
  void FitRow(int y, int count) {
    for (int x = 0; x < count; x += Lanes()) {
      FitWindows(hn::LoadU(F(), Guide(kN, y) + x + r_), x);
    }
  }

  void FitWindows(VF surface, int x) {
    const F d;
    const auto sum = [&](int index) { return hn::Load(d, s_.windows.sum.row(index) + x); };
    const auto store = [&](VF v, int index) { hn::Store(v, d, s_.fit.row(index) + x); };
    const VF weight = sum(0);
    const auto some = hn::And(hn::Gt(weight, hn::Zero(d)), hn::Gt(surface, hn::Zero(d)));
    const VF scale = hn::IfThenElseZero(some, hn::Div(hn::Set(d, 1.0f), weight));
    VF mean[kN], covariance[kN][kN];
    for (int i = 0; i < kN; ++i) mean[i] = hn::Mul(scale, sum(1 + i));
    for (int j = 0, index = kSquares; j < kN; ++j) {
      for (int i = 0; i <= j; ++i) {
        covariance[i][j] = hn::MulSub(scale, sum(index++), hn::Mul(mean[i], mean[j]));
      }
    }
    const Factors factors = Factorize(covariance);
    const auto keep = hn::And(some, factors.sound);
    for (int c = 0; c < 3; ++c) {
      const VF signal = hn::Mul(scale, sum(kSignal + c));
      VF slope[kN], offset = signal;
      for (int i = 0; i < kN; ++i) {
        slope[i] = hn::MulSub(scale, sum(kProducts + 3 * i + c), hn::Mul(mean[i], signal));
      }
      Solve(factors, slope);
      for (int i = 0; i < kN; ++i) {
        const VF a = hn::IfThenElseZero(keep, slope[i]);
        offset = hn::NegMulAdd(a, mean[i], offset);
        store(a, (kN + 1) * c + i);
      }
      store(hn::IfThenElseZero(some, offset), (kN + 1) * c + kN);
    }
    store(hn::IfThenElseZero(some, hn::Set(d, 1.0f)), 3 * (kN + 1));
  }

  void SumFits(int y, int count) {
    const int slot = block_slot(y, s_.fits.terms);
    for (int index = 0; index < s_.fits.quantities; ++index) {
      SumAlong(count, s_.fits.terms, s_.fit.row(index), s_.along.row(0));
      Push(index, slot, count, s_.along.row(0), s_.fits);
    }
    Finish(slot, s_.fits);
  }

  // The coefficients averaged over the windows that hold each pixel, applied to its guides.
  void Apply(int y, int count, Planes<3>& out) {
    const F d;
    for (int x = 0; x < count; x += Lanes()) {
      const auto fit = [&](int index) { return hn::Load(d, s_.fits.sum.row(index) + x); };
      const auto guide = [&](int index) { return hn::LoadU(d, Guide(index, y) + x + 2 * r_); };
      const VF windows = fit(3 * (kN + 1));
      const auto some = hn::And(hn::Gt(windows, hn::Zero(d)), hn::Gt(guide(kN), hn::Zero(d)));
      for (int c = 0; c < 3; ++c) {
        VF v = fit((kN + 1) * c + kN);
        for (int i = 0; i < kN; ++i) v = hn::MulAdd(fit((kN + 1) * c + i), guide(i), v);
        // Whole vectors end with the run or in the padding of the row.
        hn::StoreU(hn::IfThenElseZero(some, hn::Div(v, windows)), d,
                   out[static_cast<std::size_t>(c)].at(run_.x0 + x, y));
      }
    }
  }

  const GuidedWork& work_;
  const Tile& run_;
  GuidedScratch& s_;
  int r_;
  float epsilon_[kN];
};

void GuidedRun(const GuidedWork& work, const Tile& run, GuidedScratch& s, Planes<3>& out) {
  switch (work.options.guides) {
    case Guides::kGrayNormal:
      return Filter<1>(work, run, s).Run(out);
    case Guides::kNormal:
      return Filter<3>(work, run, s).Run(out);
    case Guides::kNormalDepth:
      return Filter<4>(work, run, s).Run(out);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(GuidedRun);

void guided_run(const GuidedWork& work, const Tile& run, GuidedScratch& scratch, Planes<3>& out) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(GuidedRun)(work, run, scratch, out);
}

}  // namespace eigenlight
#endif
