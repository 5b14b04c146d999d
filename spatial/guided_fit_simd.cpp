// Fits the windows of the guided filter from their sums, and applies the fits to pixels.
#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_fit_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

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
    for (int at = 0; at < kBlockPixels; at += LaneCount(F8())) FitWindows(at);
  }

 private:
  // Offset of a window's first sum of w N_c, w I_i I_j, w I_i N_c.
  static constexpr int kSignal = 1 + kN;
  static constexpr int kSquares = kSignal + 3;
  static constexpr int kProducts = kSquares + kN * (kN + 1) / 2;

  // Cov + diag(epsilon) = L D L^T of a window, in vectors of windows.
  struct Factors {
    VF8 lower[kN][kN];  // below the diagonal
    VF8 inverse[kN];    // of D
    MF8 sound;
  };

  // In exact arithmetic a pivot is at least epsilon, since Cov is positive semidefinite. A pivot
  // below half of it is a rounding error.
  Factors Factorize(const VF8 (&covariance)[kN][kN]) const {
    const F8 d;
    Factors f;
    f.sound = FirstLanes(LaneCount(d), d);
    VF8 scaled[kN][kN];  // L D
    for (int j = 0; j < kN; ++j) {
      for (int i = 0; i <= j; ++i) {
        VF8 v = covariance[i][j];
        for (int m = 0; m < i; ++m) v = NegMulAdd(scaled[j][m], f.lower[i][m], v);
        if (i < j) {
          scaled[j][i] = v;
          f.lower[j][i] = Mul(v, f.inverse[i]);
        } else {
          const VF8 pivot = Add(v, Set(d, epsilon_[j]));
          f.sound = And(f.sound, Gt(pivot, Set(d, 0.5f * epsilon_[j])));
          f.inverse[j] = Div(Set(d, 1.0f), pivot);
        }
      }
    }
    return f;
  }

  static void Solve(const Factors& f, VF8 (&x)[kN]) {
    for (int j = 1; j < kN; ++j) {
      for (int i = 0; i < j; ++i) x[j] = NegMulAdd(f.lower[j][i], x[i], x[j]);
    }
    for (int j = 0; j < kN; ++j) x[j] = Mul(x[j], f.inverse[j]);
    for (int j = kN - 2; j >= 0; --j) {
      for (int i = j + 1; i < kN; ++i) x[j] = NegMulAdd(f.lower[i][j], x[i], x[j]);
    }
  }

  void FitWindows(int at) {
    const F8 d;
    const auto sum = [&](int index) { return Load(d, s_.window.row(index) + at); };
    const auto store = [&](VF8 v, int index) { Store(v, d, s_.fits.row(index) + to_ + at); };
    const VF8 weight = sum(0), surface = Load(d, s_.centers.row(0) + at);
    const auto some = And(Gt(weight, Zero(d)), Gt(surface, Zero(d)));
    const VF8 scale = IfThenElseZero(some, Div(Set(d, 1.0f), weight));
    VF8 mean[kN], covariance[kN][kN];
    for (int i = 0; i < kN; ++i) mean[i] = Mul(scale, sum(1 + i));
    for (int j = 0, index = kSquares; j < kN; ++j) {
      for (int i = 0; i <= j; ++i) {
        covariance[i][j] = MulSub(scale, sum(index++), Mul(mean[i], mean[j]));
      }
    }
    const Factors factors = Factorize(covariance);
    const auto keep = And(some, factors.sound);
    for (int c = 0; c < 3; ++c) {
      const VF8 signal = Mul(scale, sum(kSignal + c));
      VF8 slope[kN], offset = signal;
      for (int i = 0; i < kN; ++i) {
        slope[i] = MulSub(scale, sum(kProducts + 3 * i + c), Mul(mean[i], signal));
      }
      Solve(factors, slope);
      for (int i = 0; i < kN; ++i) {
        const VF8 a = IfThenElseZero(keep, slope[i]);
        offset = NegMulAdd(a, mean[i], offset);
        store(a, (kN + 1) * c + i);
      }
      store(IfThenElseZero(some, offset), (kN + 1) * c + kN);
    }
    store(IfThenElseZero(some, Set(d, 1.0f)), 3 * (kN + 1));
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
  const F8 d;
  const int slot = ring_slot(where.y + row, s.slots);
  const float* surface = s.surface.row(slot) + kGuidedBlock * where.block;
  const float* values = s.values.row(where.block * s.slots + slot) + kGuidedBlock;
  for (int x = 0; x < kGuidedBlock; x += LaneCount(F8())) {
    const auto fit = [&](int index) {
      return Load(d, s.fitted.row(index) + row * kGuidedBlock + x);
    };
    const VF8 windows = fit(3 * (kN + 1));
    const auto some = And(Gt(windows, Zero(d)), Gt(Load(d, surface + x), Zero(d)));
    for (int c = 0; c < 3; ++c) {
      VF8 v = fit((kN + 1) * c + kN);
      for (int i = 0; i < kN; ++i) {
        v = MulAdd(fit((kN + 1) * c + i), Load(d, values + kGuidedBlock * i + x), v);
      }
      // Blocks end with the run or in the padding of the row.
      Store(IfThenElseZero(some, Div(v, windows)), d, out[c].row(where.y + row) + where.x + x);
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
