// Between pixel-interleaved bases and planar rows that kernels can run along.
#pragma once

#include "reproject/basis_field.h"
#include "reproject/taps.h"

namespace eigenlight {

/// Up to kSegment pixels of one row, planar: values[channel * K + k][i], and age[i].
/// After load_rows, what the last vector (Plane::kLine bytes) has behind the last pixel is zero, so
/// kernels may run over whole vectors.
struct BasisRows {
  alignas(64) float values[3 * kMaxBases][kSegment];
  alignas(64) float age[kSegment];
};

/// Reads the pixels [x0, x1) of row y0 of `row`.
void load_rows(const BasisField& field, const Tile& row, BasisRows& rows);

/// Writes them back, with zeros in the padding of each pixel.
void store_rows(const BasisRows& rows, const Tile& row, BasisField& field);

}  // namespace eigenlight
