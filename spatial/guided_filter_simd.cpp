// The sums of the guided filter, by blocks of 8 x 8 pixels.
#include <algorithm>

#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_filter_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/guided_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

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
  // A slot is reused only after its row has left all windows.
  void ClearRowsAbove() {
    for (int slot = s_.slots - s_.lead; slot < s_.slots; ++slot) {
      for (int block = 0; block < blocks_; ++block) {
        std::fill_n(s_.values.row(block * s_.slots + slot), s_.values.width(), 0.0f);
      }
      std::fill_n(s_.surface.row(slot), s_.surface.width(), 0.0f);
    }
  }

  // Rows y to y + 7 are the last of their windows, whose centers lie r rows further up; those rows
  // are the last centers of pixels that lie yet another r further up.
  void RunRows(int y, Planes<3>& out) {
    const int height = work_.in.weight.height();
    const bool fits = y >= run_.y0 && y - r_ + kGuidedBlock > 0 && y - r_ < height;
    const int first_y = y - s_.span;
    GuidedOutput where{0, 0, first_y, std::clamp(run_.y0 - first_y, 0, kGuidedBlock),
                       std::clamp(run_.y1 - first_y, 0, kGuidedBlock)};
    for (int block = 0; block < blocks_; ++block) {
      fits ? FitColumns(block, y) : SumBlock(block, y);
      const int done = block - 2 * ahead_;
      if (done < 0 || y < run_.y0) continue;
      if (block + 1 < blocks_) PrefetchFits(done + 1, y);
      fits ? SumFitsAlong(block - ahead_, y) : ClearFits(done, y);
      SumFits(done, y);
      where.block = done + ahead_;
      where.x = run_.x0 + kGuidedBlock * done;
      if (where.first_row < where.last_row) guided_apply(where, s_, out);
    }
  }

  // Sums of a block of columns, and fits of the windows that end in it.
  void FitColumns(int block, int y) {
    if (block + 1 < blocks_) PrefetchValues(block + 1, y);
    SumColumns(block, y);
    if (block >= ahead_) FitWindows(block, y);
  }

  void PrefetchValues(int block, int y) const {
    PrefetchWindows(RowWindow(y), s_.values.row(block * s_.slots), Sums(block, 0, s_.value_sums),
                    {s_.values.width(), s_.value_sums.width()});
  }

  void PrefetchFits(int block, int y) {
    PrefetchWindows(Window(s_.fit_row_windows, y), FitRow(block, 0),
                    Sums(block, 0, s_.fit_row_sums),
                    {s_.fit_rows.width(), s_.fit_row_sums.width()});
  }

  static const GuidedWindow& Window(const std::vector<GuidedWindow>& windows, int base) {
    const int slots = kGuidedBlock * static_cast<int>(windows.size());
    return windows[static_cast<std::size_t>(ring_slot(base, slots) / kGuidedBlock)];
  }

  const GuidedWindow& RowWindow(int y) const {
    return y < s_.lead ? s_.first_windows[static_cast<std::size_t>(y / kGuidedBlock)]
                       : Window(s_.value_windows, y);
  }

  // Of rows y to y + 7.
  float* Sums(int block, int y, Plane<float>& sums) const {
    return sums.row((block * s_.slots + ring_slot(y, s_.slots)) / kGuidedBlock);
  }

  // Sums over the rows y to y + 7 of a block, for later windows that contain all of them.
  void SumBlock(int block, int y) {
    float* sums = Sums(block, y, s_.value_sums);
    const auto row = s_.values.stride() * static_cast<std::size_t>(ring_slot(y, s_.slots));
    for (int x = 0; x < kGuidedBlock; x += LaneCount(F8())) {
      ForEachSum<kN>(s_.values.row(block * s_.slots) + x, [&](int sum, const auto& add) {
        VF8 all = Zero(F8());
        for (std::size_t i = 0; i < kGuidedBlock; ++i) {
          all = add(all, row + i * s_.values.stride());
        }
        Store(all, F8(), sums + kGuidedBlock * sum + x);
      });
    }
  }

  // Sums down windows that end in rows y to y + 7, into the ring of columns.
  void SumColumns(int block, int y) {
    const F8 d;
    const GuidedWindow& window = RowWindow(y);
    float* here = Sums(block, y, s_.value_sums);
    const int column = ring_slot(kGuidedBlock * block, s_.slots);
    for (int x = 0; x < kGuidedBlock; x += LaneCount(F8())) {
      const float* sums = Sums(block, 0, s_.value_sums) + x;
      ForEachSum<kN>(s_.values.row(block * s_.slots) + x, [&](int sum, const auto& add) {
        const auto whole = [&](std::size_t at) { return Load(d, sums + at + kGuidedBlock * sum); };
        VF8 down[kGuidedBlock];
        Store(SumWindows(window, add, whole, down), d, here + kGuidedBlock * sum + x);
        StoreTransposed(down, kGuidedBlock, s_.columns.row(sum) + kGuidedBlock * (column + x));
      });
    }
    SumEights(kGuidedBlock * block, s_.columns, s_.column_sums);
  }

  // Sums of eight columns of each quantity.
  void SumEights(int column, const Plane<float>& columns, Plane<float>& sums) const {
    const F8 d;
    const int slot = ring_slot(column, s_.slots);
    for (int quantity = 0; quantity < columns.height(); ++quantity) {
      const float* from = columns.row(quantity) + kGuidedBlock * slot;
      for (int row = 0; row < kGuidedBlock; row += LaneCount(F8())) {
        VF8 all = Load(d, from + row);
        for (int i = 1; i < kGuidedBlock; ++i) {
          all = Add(all, Load(d, from + kGuidedBlock * i + row));
        }
        Store(all, d, sums.row(quantity) + slot + row);
      }
    }
  }

  // Eight rows of the sums along windows of one quantity; store(row, sums) takes some of the rows.
  template <typename Sink>
  static HWY_INLINE void SumAlong(const GuidedWindow& window, const float* columns,
                                  const float* sums, const Sink& store) {
    const F8 d;
    for (int row = 0; row < kGuidedBlock; row += LaneCount(F8())) {
      const auto add = [&](VF8 sum, std::size_t at) {
        return Add(sum, Load(d, columns + at + row));
      };
      const auto whole = [&](std::size_t at) { return Load(d, sums + at + row); };
      VF8 along[kGuidedBlock];
      SumWindows(window, add, whole, along);
      store(row, along);
    }
  }

  // Windows that end in columns of `block` and rows y to y + 7.
  void FitWindows(int block, int y) {
    const F8 d;
    const int column = kGuidedBlock * block;
    const GuidedWindow& window = Window(s_.column_windows, column);
    for (int sum = 0; sum < s_.columns.height(); ++sum) {
      float* to = s_.window.row(sum);
      SumAlong(window, s_.columns.row(sum), s_.column_sums.row(sum),
               [&](int row, const VF8(&along)[kGuidedBlock]) {
                 for (int i = 0; i < kGuidedBlock; ++i) {
                   Store(along[i], d, to + kGuidedBlock * i + row);
                 }
               });
    }
    for (int x = 0; x < kGuidedBlock; x += LaneCount(F8())) {
      VF8 centers[kGuidedBlock];
      for (int i = 0; i < kGuidedBlock; ++i) {
        centers[i] = LoadU(d, s_.surface.row(ring_slot(y - r_ + i, s_.slots)) + column - r_ + x);
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
               [&](int row, const VF8(&along)[kGuidedBlock]) {
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
    const F8 d;
    const GuidedWindow& window = Window(s_.fit_row_windows, y);
    float* here = Sums(block, y, s_.fit_row_sums);
    for (int fit = 0; fit < s_.fits.height(); ++fit) {
      for (int x = 0; x < kGuidedBlock; x += LaneCount(F8())) {
        const int offset = kGuidedBlock * fit + x;
        const float* rows = FitRow(block, 0) + offset;
        const float* sums = Sums(block, 0, s_.fit_row_sums) + offset;
        const auto add = [=](VF8 sum, std::size_t at) { return Add(sum, Load(d, rows + at)); };
        const auto whole = [=](std::size_t at) { return Load(d, sums + at); };
        VF8 down[kGuidedBlock];
        Store(SumWindows(window, add, whole, down), d, here + offset);
        for (int i = 0; i < kGuidedBlock; ++i) {
          Store(down[i], d, s_.fitted.row(fit) + kGuidedBlock * i + x);
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
