// What the guided filter does at each window and each pixel, sums given.
#include "frame/float_traps.h"
#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_fit_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kGuidedBlock>;
using VF = hn::Vec<F>;

int Lanes() { return static_cast<int>(hn::Lanes(F())); }

// Fits with kN guides.
template <int kN>
class Fit {
 public:
  Fit(const GuidedOptions& options, int column, GuidedScratch& scratch)
      : s_(scratch), to_(kGuidedBlock * column) {
    for (int i = 0; i < kN; ++i) {
      epsilon_[i] = i < 3 ? options.epsilon_normal : options.epsilon_depth;
    }
  }

  void Run() {
    for (int at = 0; at < kBlockPixels; at += Lanes()) FitWindows(at);
  }

 private:
  // Offset of a window's first sum of w N_c, w I_i I_j, w I_i N_c.
  static constexpr int kSignal = 1 + kN;
  static constexpr int kSquares = kSignal + 3;
  static constexpr int kProducts = kSquares + kN * (kN + 1) / 2;

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

  void FitWindows(int at) {
    const F d;
    const auto sum = [&](int index) { return hn::Load(d, s_.window.row(index) + at); };
    const auto store = [&](VF v, int index) { hn::Store(v, d, s_.fits.row(index) + to_ + at); };
    const VF weight = sum(0), surface = hn::Load(d, s_.centers.row(0) + at);
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

  GuidedScratch& s_;
  int to_;
  float epsilon_[kN];
};

void FitBlock(const GuidedOptions& options, int column, GuidedScratch& s) {
  switch (options.guides) {
    case Guides::kGrayNormal:
      return Fit<1>(options, column, s).Run();
    case Guides::kNormal:
      return Fit<3>(options, column, s).Run();
    case Guides::kNormalDepth:
      return Fit<4>(options, column, s).Run();
  }
}

template <int kN>
void ApplyRow(const GuidedOutput& where, int row, const GuidedScratch& s, Planes<3>& out) {
  const F d;
  const int slot = ring_slot(where.y + row, s.slots);
  const float* surface = s.surface.row(slot) + kGuidedBlock * where.block;
  const float* values = s.values.row(where.block * s.slots + slot) + kGuidedBlock;
  for (int x = 0; x < kGuidedBlock; x += Lanes()) {
    const auto fit = [&](int index) {
      return hn::Load(d, s.fitted.row(index) + row * kGuidedBlock + x);
    };
    const VF windows = fit(3 * (kN + 1));
    const auto some =
        hn::And(hn::Gt(windows, hn::Zero(d)), hn::Gt(hn::Load(d, surface + x), hn::Zero(d)));
    for (int c = 0; c < 3; ++c) {
      VF v = fit((kN + 1) * c + kN);
      for (int i = 0; i < kN; ++i) {
        v = hn::MulAdd(fit((kN + 1) * c + i), hn::Load(d, values + kGuidedBlock * i + x), v);
      }
      // Blocks end with the run or in the padding of the row.
      hn::Store(hn::IfThenElseZero(some, hn::Div(v, windows)), d,
                out[static_cast<std::size_t>(c)].row(where.y + row) + where.x + x);
    }
  }
}

void ApplyBlock(const GuidedOutput& where, const GuidedScratch& s, Planes<3>& out) {
  const int guides = s.fitted.height() / 3 - 1;
  for (int row = where.first_row; row < where.last_row; ++row) {
    if (guides == 1) {
      ApplyRow<1>(where, row, s, out);
    } else if (guides == 3) {
      ApplyRow<3>(where, row, s, out);
    } else {
      ApplyRow<4>(where, row, s, out);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(FitBlock);
HWY_EXPORT(ApplyBlock);

void guided_fit(const GuidedOptions& options, int column, GuidedScratch& s) {
  HWY_DYNAMIC_DISPATCH(FitBlock)(options, column, s);
}

void guided_apply(const GuidedOutput& where, const GuidedScratch& s, Planes<3>& out) {
  HWY_DYNAMIC_DISPATCH(ApplyBlock)(where, s, out);
}

}  // namespace eigenlight
#endif
