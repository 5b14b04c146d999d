#include "spatial/guided_filter_kernel.h"

namespace eigenlight {

GuidedWindow::GuidedWindow(int base, int span_, const GuidedRing& ring, int first) : span(span_) {
  const auto slot = [&](int y) { return static_cast<std::size_t>(ring_slot(y, ring.slots)); };
  for (int i = 0; i < span + kGuidedBlock; ++i) {
    at[i] = ring.row * slot(base - span + i);
  }
  for (int y = base - span + kGuidedBlock; y < base;) {
    if (ring_slot(y, kGuidedBlock) != 0 || y + kGuidedBlock > base) {
      rest[rest_count++] = ring.row * slot(y);
      ++y;
      continue;
    }
    if (y >= first) {
      sums[sum_count++] = ring.sum * (slot(y) / kGuidedBlock);
    }
    y += kGuidedBlock;
  }
}

GuidedScratch::GuidedScratch(int radius, int guide_count)
    : span(2 * radius),
      lead(round_up_to_blocks(span)),
      slots(lead + kGuidedBlock),
      blocks((guided_strip(radius) + 2 * lead) / kGuidedBlock),
      row(kGuidedBlock * blocks),
      values({kGuidedBlock * guided_values(guide_count), blocks * slots}),
      value_sums({kGuidedBlock * guided_sums(guide_count), blocks * slots / kGuidedBlock}),
      surface({kGuidedBlock * blocks, slots}),
      columns({kGuidedBlock * slots, guided_sums(guide_count)}),
      column_sums({slots, guided_sums(guide_count)}),
      window({kBlockPixels, guided_sums(guide_count)}),
      centers({kBlockPixels, 1}),
      fits({kGuidedBlock * slots, guided_fits(guide_count)}),
      fit_sums({slots, guided_fits(guide_count)}),
      fit_rows({kGuidedBlock * guided_fits(guide_count), blocks * slots}),
      fit_row_sums({kGuidedBlock * guided_fits(guide_count), blocks * slots / kGuidedBlock}),
      fitted({kBlockPixels, guided_fits(guide_count)}) {
  const GuidedRing of_values{slots, values.stride(), value_sums.stride()};
  const GuidedRing of_columns{slots, kGuidedBlock, kGuidedBlock};
  const GuidedRing of_fits{slots, fit_rows.stride(), fit_row_sums.stride()};
  for (int base = 0; base < lead; base += kGuidedBlock) {
    first_windows.emplace_back(base, span, of_values, 0);
  }
  for (int base = 0; base < slots; base += kGuidedBlock) {
    value_windows.emplace_back(base, span, of_values, base - slots);
    column_windows.emplace_back(base, span, of_columns, base - slots);
    fit_windows.emplace_back(base + span - lead, span, of_columns, base - slots);
    fit_row_windows.emplace_back(base, span, of_fits, base - slots);
  }
}

}  // namespace eigenlight
