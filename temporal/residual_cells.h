// The frame's residual in cells of 2 x 2 pixels, and back: smoothing it wants no finer grain.
#pragma once

#include <span>

#include "frame/frame.h"
#include "frame/tiles.h"

namespace eigenlight {

struct CorrectionInputs {
  const Frame& guides;
  const Planes<3>& light;         ///< u
  const Plane<float>& confirmed;  ///< 1 where there is history and u is usable, else 0
  const Plane<float>& age;        ///< n, of the history
  const Plane<float>& samples;    ///< s, this frame's samples over its regular number
  const Plane<float>& variance;   ///< v, of one frame's luminance
};

/// Blocks of 8 x 8 pixels of a tile: those with enough confirmed pixels, and among them those whose
/// mean residual is too large for chance.
struct BlockCounts {
  std::int64_t confirmed = 0;  ///< pixels
  int all = 0, significant = 0;
};

/// Counts the blocks of neighboring tiles of one row of a grid, `counts` for each of them from the
/// left; all are `tile_width` pixels wide, a multiple of 8, but for the last of an image. `area` is
/// all of their pixels, its upper left corner at multiples of 8.
void test_blocks(const CorrectionInputs& in, const Plane<float>& residual, const Tile& area,
                 int tile_width, std::span<BlockCounts> counts);

/// Cell (X, Y) stands for the pixels 2 X + {0, 1}, 2 Y + {0, 1} that show the surface of its upper
/// left one: same object, and normals within the cosine that taps ask for.
struct ResidualCells {
  explicit ResidualCells(Extent pixels);

  /// Cells as a frame of their own, of which only camera and surface are set: each has the geometry
  /// of its upper left pixel, but id 0 and depth +inf, as where there is no surface, if none of its
  /// pixels is confirmed: what says nothing must not count as a residual of 0.
  Frame guides;
  Planes<3> mean;      ///< of u - prediction over the confirmed pixels
  Plane<float> noise;  ///< variance of the mean's luminance: sum v (1/s + 1/n) / count^2
  Plane<float> count;  ///< confirmed pixels, 0 to 4

  [[nodiscard]] Extent extent() const { return count.extent(); }
  /// Takes over the frame's camera: the ray of a cell's center is that of its upper left pixel.
  void set_camera(const Camera& camera);
};

/// Fills the cells of `tile` (in units of cells; its left edge a multiple of 8).
void load_cells(const CorrectionInputs& in, const Planes<3>& prediction, const Tile& tile,
                ResidualCells& cells);

struct SpreadOutputs {
  Planes<3>& correction;   ///< set
  Plane<float>& residual;  ///< minus its luminance
};

/// Brings cells.mean back to the confirmed pixels of `tile`: the mean of the four cells around,
/// bilinear, of those that show the pixel's surface (object, normal and plane, as for taps);
/// where none does, of those that show its object; else 0.
void spread_cells(const ResidualCells& cells, const CorrectionInputs& in, const Tile& tile,
                  const SpreadOutputs& out);

}  // namespace eigenlight
