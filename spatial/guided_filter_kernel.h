// The guided filter of one tile; see guided_filter.h.
#pragma once

#include "spatial/guided_filter.h"

namespace eigenlight {

inline constexpr int kGuidedTile = 64;
inline constexpr int kGuidedRadius = 16;  ///< largest
inline constexpr int kGuides = 4;         ///< three of the normal, log depth

/// Sums that a window's fit needs, each over the window: w; w I_i; w N_c; w I_i I_j, i <= j;
/// w I_i N_c.
inline constexpr int kGuidedSums = 1 + kGuides + 3 + kGuides * (kGuides + 1) / 2 + 3 * kGuides;

/// A block of pixels with room for whole vectors behind each row and behind the last one.
template <int kSide>
struct GuidedBlock {
  static constexpr int kStride = kSide + 16;
  alignas(64) float data[kSide * kStride + 64];
  [[nodiscard]] float* row(int y) { return data + y * kStride; }
  [[nodiscard]] const float* row(int y) const { return data + y * kStride; }
};

/// A tile with the pixels that its windows see: its own, `radius` more on each side where windows
/// are centered that reach into the tile (coefficients), and `radius` more that those windows hold.
struct GuidedScratch {
  using Seen = GuidedBlock<kGuidedTile + 4 * kGuidedRadius>;
  using Windows = GuidedBlock<kGuidedTile + 2 * kGuidedRadius>;

  Seen guide[kGuides];           // less their mean over the block; 0 without surface
  Seen weighted_guide[kGuides];  // w I
  Seen weighted_signal[3];       // w N
  Seen weight, surface;          // surface: 1 or 0
  Seen sums, partial;            // of one quantity along rows, and what doubling leaves
  Windows window[kGuidedSums];   // sums, then in their place coefficients
};

void guided_tile(const GuidedInputs& in, const GuidedOptions& options, const Tile& tile,
                 GuidedScratch& scratch, Planes<3>& out);

}  // namespace eigenlight
