// The sums of the guided filter, by blocks of 8 x 8 pixels.
#include <algorithm>

#include "frame/float_traps.h"
#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_filter_simd.cpp"
// Not in alphabetical order: foreach_target.h has to come first.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/cache_control.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kGuidedBlock>;
using VF = hn::Vec<F>;

int Lanes() { return static_cast<int>(hn::Lanes(F())); }

// Lane i of the eight vectors to the eight floats at to + i * stride, for all lanes.
HWY_INLINE void StoreTransposed(const VF (&v)[kGuidedBlock], std::size_t stride,
                                float* HWY_RESTRICT to) {
#if HWY_TARGET == HWY_SCALAR
  for (int i = 0; i < kGuidedBlock; ++i) to[i] = v[i].raw;
  static_cast<void>(stride);
#else
  const F d;
  const hn::Repartition<std::uint64_t, F> pairs;
  // Of each 128 bits: column[half][i] is lane i of the vectors 4 half to 4 half + 3.
  VF column[2][4];
  for (int half = 0; half < 2; ++half) {
    const VF* rows = v + 4 * half;
    const auto low0 = hn::BitCast(pairs, hn::InterleaveLower(d, rows[0], rows[1]));
    const auto low1 = hn::BitCast(pairs, hn::InterleaveLower(d, rows[2], rows[3]));
    const auto high0 = hn::BitCast(pairs, hn::InterleaveUpper(d, rows[0], rows[1]));
    const auto high1 = hn::BitCast(pairs, hn::InterleaveUpper(d, rows[2], rows[3]));
    column[half][0] = hn::BitCast(d, hn::InterleaveLower(pairs, low0, low1));
    column[half][1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low0, low1));
    column[half][2] = hn::BitCast(d, hn::InterleaveLower(pairs, high0, high1));
    column[half][3] = hn::BitCast(d, hn::InterleaveUpper(pairs, high0, high1));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (Lanes() == 4) {
      hn::Store(column[0][i], d, to + i * stride);
      hn::Store(column[1][i], d, to + i * stride + 4);
    } else {
      hn::Store(hn::ConcatLowerLower(d, column[1][i], column[0][i]), d, to + i * stride);
      hn::Store(hn::ConcatUpperUpper(d, column[1][i], column[0][i]), d, to + (i + 4) * stride);
    }
  }
#endif
}

// The sums of eight windows, and of the eight rows that are in the last of them alone. add(sum,
// at) adds a row to a sum, whole(at) is a sum of rows. Nothing is subtracted: a sum
// holds no trace of what is not in its window.
template <typename Add, typename Whole>
HWY_INLINE VF SumWindows(const GuidedWindow& w, const Add& add, const Whole& whole,
                         VF (&sum)[kGuidedBlock]) {
  VF after = hn::Zero(F());
  if (w.span < kGuidedBlock) {
    for (int g = 0; g < kGuidedBlock; ++g) {
      after = add(after, w.at[static_cast<std::size_t>(w.span + g)]);
      sum[g] = hn::Zero(F());
      for (int i = g; i <= g + w.span; ++i) sum[g] = add(sum[g], w.at[static_cast<std::size_t>(i)]);
    }
    return after;
  }
  VF before = hn::Zero(F());
  for (int i = 0; i < w.sum_count; ++i) {
    before = hn::Add(before, whole(w.sums[static_cast<std::size_t>(i)]));
  }
  for (int i = 0; i < w.rest_count; ++i) before = add(before, w.rest[static_cast<std::size_t>(i)]);
  for (int g = kGuidedBlock - 1; g >= 0; --g) {
    sum[g] = before = add(before, w.at[static_cast<std::size_t>(g)]);
  }
  for (int g = 0; g < kGuidedBlock; ++g) {
    after = add(after, w.at[static_cast<std::size_t>(w.span + g)]);
    sum[g] = hn::Add(sum[g], after);
  }
  return after;
}

struct Lengths {
  int row, sum;  // floats
};

// Rows and sums that SumWindows() is going to read: wide windows outgrow the second-level cache.
void Fetch(const GuidedWindow& w, const float* rows, const float* sums, const Lengths& lengths) {
  constexpr int kLine = 16;
  for (std::size_t g = 0; g < kGuidedBlock; ++g) {
    for (int x = 0; x < lengths.row; x += kLine) hwy::Prefetch(rows + w.at[g] + x);
  }
  for (int i = 0; i < w.sum_count; ++i) {
    for (int x = 0; x < lengths.sum; x += kLine) {
      hwy::Prefetch(sums + w.sums[static_cast<std::size_t>(i)] + x);
    }
  }
}

// The filter with kN guides.
template <int kN>
class Filter {
 public:
  Filter(const GuidedWork& work, const Rect& run, GuidedScratch& scratch)
      : work_(work),
        run_(run),
        s_(scratch),
        r_(work.options.radius),
        ahead_(s_.lead / kGuidedBlock),
        blocks_(round_up_to_blocks(run.x1 - run.x0) / kGuidedBlock + 2 * ahead_) {}

  void Run(Planes<3>& out) {
    if (run_.y0 == 0) ClearRowsAbove();
    const GuidedColumns columns{run_.x0 - s_.lead, kGuidedBlock * blocks_};
    for (int y = std::max(run_.y0 - s_.lead, 0); y < run_.y1 + s_.span; y += kGuidedBlock) {
      for (int i = 0; i < kGuidedBlock; ++i) guided_load_row(work_, columns, y + i, s_);
      RunRows(y, out);
    }
  }

 private:
  // No row comes into their slots before they have left all windows.
  void ClearRowsAbove() {
    for (int slot = s_.slots - s_.lead; slot < s_.slots; ++slot) {
      for (int block = 0; block < blocks_; ++block) {
        std::fill_n(s_.values.row(block * s_.slots + slot), s_.values.width(), 0.0f);
      }
      std::fill_n(s_.surface.row(slot), s_.surface.width(), 0.0f);
    }
  }

  // Rows y to y + 7 are the last of their windows, whose centers are r rows further up; those of
  // which pixels are the last center yet another r.
  void RunRows(int y, Planes<3>& out) {
    const int height = work_.in.weight.height();
    const bool fits = y >= run_.y0 && y - r_ + kGuidedBlock > 0 && y - r_ < height;
    GuidedOutput where{0, 0, y - s_.span, std::clamp(run_.y0 - (y - s_.span), 0, kGuidedBlock),
                       std::clamp(run_.y1 - (y - s_.span), 0, kGuidedBlock)};
    for (int block = 0; block < blocks_; ++block) {
      if (!fits) {
        SumBlock(block, y);
      } else {
        if (block + 1 < blocks_) {
          Fetch(RowWindow(y), s_.values.row((block + 1) * s_.slots),
                Sums(block + 1, 0, s_.value_sums), {s_.values.width(), s_.value_sums.width()});
        }
        SumColumns(block, y);
        if (block >= ahead_) FitWindows(block, y);
      }
      const int done = block - 2 * ahead_;
      if (done < 0 || y < run_.y0) continue;
      if (block + 1 < blocks_) {
        Fetch(Window(s_.fit_row_windows, y), FitRow(done + 1, 0),
              Sums(done + 1, 0, s_.fit_row_sums), {s_.fit_rows.width(), s_.fit_row_sums.width()});
      }
      if (fits) {
        SumFitsAlong(block - ahead_, y);
      } else {
        ClearFits(done, y);
      }
      SumFits(done, y);
      where.block = done + ahead_;
      where.x = run_.x0 + kGuidedBlock * done;
      if (where.first_row < where.last_row) guided_apply(where, s_, out);
    }
  }

  static const GuidedWindow& Window(const std::vector<GuidedWindow>& windows, int base) {
    const int slots = kGuidedBlock * static_cast<int>(windows.size());
    return windows[static_cast<std::size_t>(ring_slot(base, slots) / kGuidedBlock)];
  }

  // Calls visit(sum, add) for each sum of a block of columns, where add(v, row) adds what one row
  // gives to it.
  template <typename Visit>
  void ForSums(const float* values, const Visit& visit) const {
    const F d;
    const auto at = [=](int value, std::size_t row) {
      return hn::Load(d, values + row + kGuidedBlock * value);
    };
    int next = 0;
    const auto plain = [&](int a) {
      visit(next++, [=](VF sum, std::size_t row) { return hn::Add(sum, at(a, row)); });
    };
    plain(0);
    for (int i = 1; i <= kN; ++i) {
      visit(next++,
            [=](VF sum, std::size_t row) { return hn::MulAdd(at(0, row), at(i, row), sum); });
    }
    for (int c = 1 + kN; c < 4 + kN; ++c) plain(c);
    for (int j = 1; j <= kN; ++j) {
      for (int i = 1; i <= j; ++i) {
        visit(next++, [=](VF sum, std::size_t row) {
          return hn::MulAdd(hn::Mul(at(0, row), at(i, row)), at(j, row), sum);
        });
      }
    }
    for (int i = 1; i <= kN; ++i) {
      for (int c = 1 + kN; c < 4 + kN; ++c) {
        visit(next++,
              [=](VF sum, std::size_t row) { return hn::MulAdd(at(c, row), at(i, row), sum); });
      }
    }
  }

  const GuidedWindow& RowWindow(int y) const {
    return y < s_.lead ? s_.first_windows[static_cast<std::size_t>(y / kGuidedBlock)]
                       : Window(s_.value_windows, y);
  }

  // Of rows y to y + 7.
  float* Sums(int block, int y, Plane<float>& sums) const {
    return sums.row((block * s_.slots + ring_slot(y, s_.slots)) / kGuidedBlock);
  }

  // Rows y to y + 7 of a block, each sum over all of them: what windows have of them later.
  void SumBlock(int block, int y) {
    float* sums = Sums(block, y, s_.value_sums);
    const auto row = s_.values.stride() * static_cast<std::size_t>(ring_slot(y, s_.slots));
    for (int x = 0; x < kGuidedBlock; x += Lanes()) {
      ForSums(s_.values.row(block * s_.slots) + x, [&](int sum, const auto& add) {
        VF all = hn::Zero(F());
        for (std::size_t i = 0; i < kGuidedBlock; ++i) {
          all = add(all, row + i * s_.values.stride());
        }
        hn::Store(all, F(), sums + kGuidedBlock * sum + x);
      });
    }
  }

  // Sums down windows that end in rows y to y + 7, into the ring of columns.
  void SumColumns(int block, int y) {
    const F d;
    const GuidedWindow& window = RowWindow(y);
    float* here = Sums(block, y, s_.value_sums);
    const int column = ring_slot(kGuidedBlock * block, s_.slots);
    for (int x = 0; x < kGuidedBlock; x += Lanes()) {
      const float* sums = Sums(block, 0, s_.value_sums) + x;
      ForSums(s_.values.row(block * s_.slots) + x, [&](int sum, const auto& add) {
        const auto whole = [&](std::size_t at) {
          return hn::Load(d, sums + at + kGuidedBlock * sum);
        };
        VF down[kGuidedBlock];
        hn::Store(SumWindows(window, add, whole, down), d, here + kGuidedBlock * sum + x);
        StoreTransposed(down, kGuidedBlock, s_.columns.row(sum) + kGuidedBlock * (column + x));
      });
    }
    SumEights(kGuidedBlock * block, s_.columns, s_.column_sums);
  }

  // Sums of eight columns of each quantity.
  void SumEights(int column, const Plane<float>& columns, Plane<float>& sums) const {
    const F d;
    const int slot = ring_slot(column, s_.slots);
    for (int quantity = 0; quantity < columns.height(); ++quantity) {
      const float* from = columns.row(quantity) + kGuidedBlock * slot;
      for (int row = 0; row < kGuidedBlock; row += Lanes()) {
        VF all = hn::Load(d, from + row);
        for (int i = 1; i < kGuidedBlock; ++i) {
          all = hn::Add(all, hn::Load(d, from + kGuidedBlock * i + row));
        }
        hn::Store(all, d, sums.row(quantity) + slot + row);
      }
    }
  }

  // Eight rows of the sums along windows of one quantity; store(row, sums) takes some of the rows.
  template <typename Store>
  static HWY_INLINE void SumAlong(const GuidedWindow& window, const float* columns,
                                  const float* sums, const Store& store) {
    const F d;
    for (int row = 0; row < kGuidedBlock; row += Lanes()) {
      const auto add = [&](VF sum, std::size_t at) {
        return hn::Add(sum, hn::Load(d, columns + at + row));
      };
      const auto whole = [&](std::size_t at) { return hn::Load(d, sums + at + row); };
      VF along[kGuidedBlock];
      SumWindows(window, add, whole, along);
      store(row, along);
    }
  }

  // Windows that end in columns of `block` and rows y to y + 7.
  void FitWindows(int block, int y) {
    const F d;
    const int column = kGuidedBlock * block;
    const GuidedWindow& window = Window(s_.column_windows, column);
    for (int sum = 0; sum < s_.columns.height(); ++sum) {
      float* to = s_.window.row(sum);
      SumAlong(window, s_.columns.row(sum), s_.column_sums.row(sum),
               [&](int row, const VF(&along)[kGuidedBlock]) {
                 for (int i = 0; i < kGuidedBlock; ++i) {
                   hn::Store(along[i], d, to + kGuidedBlock * i + row);
                 }
               });
    }
    for (int x = 0; x < kGuidedBlock; x += Lanes()) {
      VF centers[kGuidedBlock];
      for (int i = 0; i < kGuidedBlock; ++i) {
        centers[i] =
            hn::LoadU(d, s_.surface.row(ring_slot(y - r_ + i, s_.slots)) + column - r_ + x);
      }
      StoreTransposed(centers, kGuidedBlock, s_.centers.row(0) + kGuidedBlock * x);
    }
    guided_fit(work_.options, ring_slot(column - s_.lead, s_.slots), s_);
    SumEights(column - s_.lead, s_.fits, s_.fit_sums);
  }

  float* FitRow(int block, int slot) { return s_.fit_rows.row(block * s_.slots + slot); }

  // Sums along the fits that end in a block of columns `ahead_` further on, or what is left of
  // them.
  void SumFitsAlong(int block, int y) {
    const GuidedWindow& window = Window(s_.fit_windows, kGuidedBlock * block);
    float* to = FitRow(block - ahead_, ring_slot(y, s_.slots));
    for (int fit = 0; fit < s_.fits.height(); ++fit) {
      SumAlong(window, s_.fits.row(fit), s_.fit_sums.row(fit),
               [&](int row, const VF(&along)[kGuidedBlock]) {
                 const std::size_t stride = s_.fit_rows.stride();
                 StoreTransposed(along, stride,
                                 to + stride * static_cast<std::size_t>(row) + kGuidedBlock * fit);
               });
    }
  }

  void ClearFits(int block, int y) {
    for (int i = 0; i < kGuidedBlock; ++i) {
      std::fill_n(FitRow(block, ring_slot(y, s_.slots) + i), s_.fit_rows.width(), 0.0f);
    }
  }

  // Sums of fits down windows that end in rows y to y + 7.
  void SumFits(int block, int y) {
    const F d;
    const GuidedWindow& window = Window(s_.fit_row_windows, y);
    float* here = Sums(block, y, s_.fit_row_sums);
    for (int fit = 0; fit < s_.fits.height(); ++fit) {
      for (int x = 0; x < kGuidedBlock; x += Lanes()) {
        const int offset = kGuidedBlock * fit + x;
        const float* rows = FitRow(block, 0) + offset;
        const float* sums = Sums(block, 0, s_.fit_row_sums) + offset;
        const auto add = [=](VF sum, std::size_t at) {
          return hn::Add(sum, hn::Load(d, rows + at));
        };
        const auto whole = [=](std::size_t at) { return hn::Load(d, sums + at); };
        VF down[kGuidedBlock];
        hn::Store(SumWindows(window, add, whole, down), d, here + offset);
        for (int i = 0; i < kGuidedBlock; ++i) {
          hn::Store(down[i], d, s_.fitted.row(fit) + kGuidedBlock * i + x);
        }
      }
    }
  }

  const GuidedWork& work_;
  const Rect& run_;
  GuidedScratch& s_;
  int r_;
  int ahead_;   // blocks from a pixel's own to the last of the windows around it
  int blocks_;  // of columns
};

void GuidedRun(const GuidedWork& work, const Rect& run, GuidedScratch& s, Planes<3>& out) {
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

void guided_run(const GuidedWork& work, const Rect& run, GuidedScratch& scratch, Planes<3>& out) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(GuidedRun)(work, run, scratch, out);
}

}  // namespace eigenlight
#endif
