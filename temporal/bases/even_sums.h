// Sums for the gain of a light that do not know the noise of its history.
#pragma once

#include "temporal/bases/tile_sums.h"

namespace eigenlight {

/// Adds the pixels of `part` of a tile to `sums` as accumulate_tile() does, for basis 0 alone and
/// with luminance l(.) in place of inner products:
///   gram = sum_p m l(V_0),   innovation = sum_p m l(u - V_0),   m = n / (n + 1).
/// Then delta_0 = innovation / gram is a ratio of sums of light. <V_0, u - V_0> / <V_0, V_0> holds
/// the square of the noise of V_0 below, but not above: where history is short, it makes every
/// light darker by 5 to 25 % (docs/experiments/2026-12-real-frames.md). No pixel loses influence,
/// for what is taken from the bright ones is missing in the sum.
void accumulate_even(const SumInputs& history, const Tile& part, TileSums& sums);

}  // namespace eigenlight
