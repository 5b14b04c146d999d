// The guided filter of a run of tiles; see guided_filter.h.
#pragma once

#include <algorithm>

#include "spatial/guided_filter.h"

namespace eigenlight {

inline constexpr int kGuidedTile = 64;    ///< pixels on a side of what is filtered or left alone
inline constexpr int kGuidedRadius = 32;  ///< largest: Bauszat 2011 takes 24 to 32
inline constexpr int kMostGuides = 4;
inline constexpr int kGuidedRoom = 32;  ///< floats behind a row that whole vectors may touch

/// Most columns of a run. Halos of 2 radius on either side make narrow strips dear, rows that
/// outgrow the second-level cache wide ones: 8 to 32 radius were tried (spatial/README.md).
[[nodiscard]] constexpr int guided_strip(int radius) {
  return std::max(2 * kGuidedTile, 16 * radius / kGuidedTile * kGuidedTile);
}

/// Sums over a window that the fit of n guides needs: w; w I_i; w N_c; w I_i I_j, i <= j; w I_i
/// N_c.
[[nodiscard]] constexpr int guided_sums(int n) { return 1 + n + 3 + n * (n + 1) / 2 + 3 * n; }
/// What a fit leaves: a and b of each channel, and 1 if the window counts.
[[nodiscard]] constexpr int guided_fits(int n) { return 3 * (n + 1) + 1; }

/// Sums over the last `terms` rows of some quantities, for a run of rows. Blocks of `terms` rows
/// begin at row numbers that they divide, so that sums have the same bits wherever a run begins.
struct ColumnSums {
  ColumnSums(int terms_, int quantities_, int width)
      : terms(terms_),
        quantities(quantities_),
        slots({width, terms * quantities}),
        prefix({width, quantities}),
        sum({width, quantities}) {}

  int terms, quantities;
  Plane<float> slots;   // of row y % terms; from the block before, below this row: what follows it
  Plane<float> prefix;  // sums of the block so far
  Plane<float> sum;     // of the last `terms` rows
};

/// Rows as they come, then as they count. Columns begin 2 radius left of the run.
struct GuidedRow {
  explicit GuidedRow(int width)
      : normal(make_planes<3>({width, 1})),
        signal(make_planes<3>({width, 1})),
        depth({width, 1}),
        weight({width, 1}),
        id({width, 1}) {}

  Planes<3> normal, signal;  // signal: afterwards w N, 0 where it does not count
  Plane<float> depth, weight;
  Plane<std::uint32_t> id;
};

struct GuidedScratch {
  GuidedScratch(int radius, int guide_count)
      : width(guided_strip(radius) + 4 * radius + kGuidedRoom),
        row(width),
        guides({width, (2 * radius + 1) * (guide_count + 1)}),
        weighted_guide({width, guide_count}),
        partial({width, 1}),
        along({width, 1}),
        windows(2 * radius + 1, guided_sums(guide_count), width),
        fit({width, guided_fits(guide_count)}),
        fits(2 * radius + 1, guided_fits(guide_count), width) {}

  int width;
  GuidedRow row;
  Plane<float> guides;  // guides, then 1 for surface, of row y % (2 radius + 1)
  Plane<float> weighted_guide;
  Plane<float> partial,
      along;  // a quantity, what doubling leaves of it, and its sums along the row
  ColumnSums windows;
  Plane<float> fit;  // of one row of windows
  ColumnSums fits;
};

struct GuidedWork {
  const GuidedInputs& in;
  const GuidedOptions& options;
  float log_depth;  ///< taken off every log depth, so that covariances keep their digits in float
};

/// Row y of the columns [left, left + width), zeros outside the image: fills scratch.row and the
/// guides of the row.
struct GuidedColumns {
  int left, width;
};
void guided_load_row(const GuidedWork& work, const GuidedColumns& columns, int y,
                     GuidedScratch& scratch);

/// Position of a row in its block of `terms`.
[[nodiscard]] constexpr int block_slot(int y, int terms) { return (y % terms + terms) % terms; }

void guided_run(const GuidedWork& work, const Tile& run, GuidedScratch& scratch, Planes<3>& out);

}  // namespace eigenlight
