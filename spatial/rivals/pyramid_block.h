// What the vectors of the pyramid filter read: the pixels of a tile and around it, side by side.
#pragma once

#include "spatial/rivals/pyramid_kernel.h"

namespace eigenlight {

/// Signal times weight (3), weight, normal (3), depth.
enum PyramidChannel { kRed, kWeight = 3, kNormal, kDepth = 7, kPyramidChannels };

/// Columns to the left of a tile and to its right: the longest vector.
inline constexpr int kPyramidMargin = 16;

/// Rows of a tile with those around it; 0 where there is no pixel or no surface. Pixel (x0, y0) of
/// the tile is at column kPyramidMargin of row 1.
template <int kRows>
struct PyramidBlock {
  static constexpr int kStride = kPyramidTileWidth + 2 * kPyramidMargin;
  alignas(64) float data[kPyramidChannels][kRows][kStride];
};

/// A border of 1 row and column.
using PyramidFineBlock = PyramidBlock<kPyramidTileHeight + 2>;
/// The same of the coarser level, each value twice, so that the sample i of the pixel at column x
/// stands at x + 2 i.
using PyramidCoarseBlock = PyramidBlock<kPyramidTileHeight / 2 + 2>;

/// The pixels from (x0, y0) on, whether or not a tile of the level starts there, and `border` (0 or
/// 1) pixels around them; the rest of the block stays as it is.
void load_pyramid_block(const PyramidView& level, int x0, int y0, int border,
                        PyramidFineBlock& block);

/// Attributes and I_up of the level above `tile`.
void load_coarser_block(const PyramidPlanes& level, const Rect& tile, PyramidCoarseBlock& block);

}  // namespace eigenlight
