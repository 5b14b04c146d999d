// The guided filter of a run of tiles; see guided_filter.h.
#pragma once

#include <algorithm>
#include <vector>

#include "spatial/guided_filter.h"

namespace eigenlight {

inline constexpr int kGuidedTile = 64;    ///< pixels on a side of what is filtered or left alone
inline constexpr int kGuidedRadius = 32;  ///< largest: Bauszat 2011 takes 24 to 32
inline constexpr int kMostGuides = 4;
/// Rows, and columns, that are summed in one go.
inline constexpr int kGuidedBlock = 8;
inline constexpr int kBlockPixels = kGuidedBlock * kGuidedBlock;

/// Most columns of a run. Halos of 2 radius on either side make narrow runs slow; wide runs leave
/// threads without work: docs/performance.md.
[[nodiscard]] constexpr int guided_strip(int radius) {
  return std::max(2 * kGuidedTile, 16 * radius / kGuidedTile * kGuidedTile);
}

/// Values of a pixel that are summed: w, guides I_i, w N_c.
[[nodiscard]] constexpr int guided_values(int n) { return 1 + n + 3; }
/// Sums over a window that the fit of n guides needs: w; w I_i; w N_c; w I_i I_j, i <= j; w I_i
/// N_c.
[[nodiscard]] constexpr int guided_sums(int n) { return 1 + n + 3 + n * (n + 1) / 2 + 3 * n; }
/// Values of a fit: a and b of each channel, and 1 if the window counts.
[[nodiscard]] constexpr int guided_fits(int n) { return 3 * (n + 1) + 1; }

[[nodiscard]] constexpr int round_up_to_blocks(int n) {
  return (n + kGuidedBlock - 1) / kGuidedBlock * kGuidedBlock;
}

/// Position in the ring of row or column `y`, any integer.
[[nodiscard]] constexpr int ring_slot(int y, int slots) { return (y % slots + slots) % slots; }

/// How far apart rows of a ring lie, and sums of its blocks of eight.
struct GuidedRing {
  int slots;
  std::size_t row, sum;
};
/// Where the rows and sums that make eight windows of span + 1 rows lie in a ring. Window g holds
/// the rows from base - span + g to base + g. All eight share the rows [base - span + 8, base):
/// where these fill whole blocks of eight from a multiple of eight on, their sums exist already.
struct GuidedWindow {
  /// Rows before `first` do not exist and are left out.
  GuidedWindow(int base, int span, const GuidedRing& ring, int first);

  int span;
  std::size_t at[2 * kGuidedRadius + kGuidedBlock] = {};    ///< of row base - span + i
  std::size_t sums[2 * kGuidedRadius / kGuidedBlock] = {};  ///< within the common rows
  std::size_t rest[kGuidedBlock] = {};                      ///< of common rows outside such blocks
  int sum_count = 0, rest_count = 0;
};

/// Rows of the image, first raw, then weighted. Columns begin `lead` left of the run.
struct GuidedRow {
  explicit GuidedRow(int width)
      : normal(make_planes<3>({width, 1})),
        signal(make_planes<3>({width, 1})),
        depth({width, 1}),
        weight({width, 1}),
        id({width, 1}) {}

  Planes<3> normal, signal;
  Plane<float> depth, weight;
  Plane<std::uint32_t> id;
};

/// Rings of the last rows and, within a block of rows, of the last columns. A ring holds as many as
/// a window reaches back, rounded up to blocks, and the present block. The values of a block are
/// contiguous.
struct GuidedScratch {
  GuidedScratch(int radius, int guide_count);

  int span, lead;  ///< 2 radius, and that in whole blocks
  int slots;       ///< of a ring
  int blocks;      ///< of columns, those left of the run among them

  GuidedRow row;
  Plane<float> values;      ///< row block * slots + slot: 8 columns of each value
  Plane<float> value_sums;  ///< row (block * slots + slot) / 8: 8 columns of each sum over 8 rows
  Plane<float> surface;     ///< row slot: 1 where there is surface

  Plane<float> columns;      ///< row sum: slots columns of 8 rows, summed over rows
  Plane<float> column_sums;  ///< row sum: those over 8 columns
  Plane<float> window;       ///< row sum: 8 columns of 8 rows, of windows
  Plane<float> centers;      ///< 8 columns of 8 rows: `surface` at the centers of these

  Plane<float> fits;      ///< row fit: slots columns of 8 rows
  Plane<float> fit_sums;  ///< row fit: over 8 columns

  Plane<float> fit_rows;  ///< row block * slots + slot: 8 columns of each fit, summed over columns
  Plane<float> fit_row_sums;  ///< row (block * slots + slot) / 8: over 8 rows
  Plane<float> fitted;        ///< row fit: 8 rows of 8 columns, summed over rows, too

  /// Windows by the block of the ring in which they end: of `values` (`first_windows` are those of
  /// the first `lead` rows of the image), of `columns` and of `fit_rows`. Those of `fits` end lead
  /// - span columns further left, so that the filtered pixels begin with a block.
  std::vector<GuidedWindow> first_windows, value_windows, column_windows, fit_windows,
      fit_row_windows;
};

struct GuidedWork {
  const GuidedInputs& in;
  const GuidedOptions& options;
  float log_depth;  ///< taken off every log depth, so that covariances keep their digits in float
};

/// Columns [left, left + width) of the image and beyond it; width is of whole blocks.
struct GuidedColumns {
  int left, width;
};
/// Puts row y, zeros outside the image, into its slot of s.values and s.surface.
void guided_load_row(const GuidedWork& work, const GuidedColumns& columns, int y, GuidedScratch& s);

/// Fits the windows of s.window into columns [column, column + 8) of s.fits.
void guided_fit(const GuidedOptions& options, int column, GuidedScratch& s);

/// A block of 8 x 8 pixels: its column among those of s.values, where it is in the image, and which
/// of its rows are wanted.
struct GuidedOutput {
  int block, x, y, first_row, last_row;
};
/// The coefficients averaged over the windows that hold each pixel, applied to its guides.
void guided_apply(const GuidedOutput& where, const GuidedScratch& s, Planes<3>& out);

void guided_run(const GuidedWork& work, const Rect& run, GuidedScratch& scratch, Planes<3>& out);

}  // namespace eigenlight
