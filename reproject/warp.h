// Fetches bases and ages, or one plane, through taps.
#pragma once

#include "reproject/basis_field.h"
#include "reproject/taps.h"

namespace eigenlight {

/// to(p) = sum over the four taps of weight * from(tap), for the pixels [x0, x1) of row y0 of
/// `row`, x0 a multiple of kBlock: bases and age alike. Zero where all weights are zero. Warped
/// bases are no longer orthogonal. `from` holds finite values and as many bases as `to`; they must
/// not alias.
void warp_bases(const BasisField& from, const TapSegment& taps, const Rect& row, BasisField& to);

/// The same for one channel.
void warp_plane(const Plane<float>& from, const TapSegment& taps, const Rect& row,
                Plane<float>& to);

}  // namespace eigenlight
