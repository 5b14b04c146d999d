// Downsamples the residual to cells of 2 x 2 pixels and back; smoothing needs no finer resolution.
#pragma once

#include <span>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "reproject/taps.h"

namespace eigenlight {

struct CorrectionInputs {
  const FrameInput& guides;
  const Planes<3>& residual;       ///< u - prediction
  const Plane<float>& innovation;  ///< its luminance; NaN: not confirmed
  const Plane<float>& age;         ///< n, of the history
  const Plane<float>& samples;     ///< s, this frame's samples over its regular number
  const Plane<float>& variance;    ///< v, of one frame's luminance
};

/// Side of a block in pixels.
inline constexpr int kResidualBlock = 8;

struct ResidualBlock {
  int confirmed = 0;            ///< pixels
  bool is_asked = false;        ///< these are enough to tell
  bool is_significant = false;  ///< and their mean innovation is too large for chance
};

/// Tests the blocks of one row from the left; `area` is all of their pixels.
void test_blocks(const CorrectionInputs& in, const Rect& area, std::span<ResidualBlock> blocks);

/// Cell (X, Y) stands for the pixels 2 X + {0, 1}, 2 Y + {0, 1} that show the surface of its upper
/// left one: same object, and normals within the cosine that taps ask for. These are its members.
struct ResidualCells {
  explicit ResidualCells(Extent pixels, const TapOptions& same_surface = {});

  /// Cells as a frame of their own, of which only camera and surface are set: each has the geometry
  /// of its upper left pixel, but id 0 and depth +inf, as where there is no surface, if none of its
  /// pixels is confirmed: an unknown residual must not count as 0.
  FrameInput guides;
  TapOptions taps;              ///< what counts as the same surface
  Planes<3> mean;               ///< residual of the confirmed pixels
  Plane<float> noise;           ///< variance of the mean's luminance: sum v (1/s + 1/n) / count^2
  Plane<float> count;           ///< confirmed pixels, 0 to 4
  Plane<std::uint8_t> members;  ///< bit q: the pixel at q % 2, q / 2 is one

  [[nodiscard]] Extent extent() const { return count.extent(); }
  /// Takes over the frame's camera: the ray of a cell's center is that of its upper left pixel.
  void set_camera(const Camera& camera);
};

/// Cells are filled so many at a time along a row.
inline constexpr int kCellStep = 8;

/// Gives the cells of `tile` (in units of cells; its left edge a multiple of kCellStep) their
/// members and their geometry.
void place_cells(const GBuffer& surface, const Rect& tile, ResidualCells& cells);

/// Fills the placed cells of `tile` with what their confirmed members hold. Those without any lose
/// their geometry, until they are placed again.
void load_cells(const CorrectionInputs& in, const Rect& tile, ResidualCells& cells);

struct SpreadOutputs {
  Planes<3>& correction;     ///< set
  Plane<float>& innovation;  ///< minus its luminance
};

struct SpreadLayer {
  const ResidualCells& cells;
  SpreadOutputs out;
};

/// Brings cells.mean back to the confirmed pixels of `tile`: the mean of the four cells around,
/// bilinear, of those that show the pixel's surface (object, normal and plane, as for taps);
/// where none does, of those that show its object; else 0. Several layers share the weights: their
/// cells have the same geometry around the tile.
void spread_cells(std::span<const SpreadLayer> layers, const FrameInput& guides, const Rect& tile);

}  // namespace eigenlight
