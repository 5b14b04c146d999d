// Adds changes of light to the history that many neighbors share and no basis explains.
#pragma once

#include "frame/frame.h"
#include "spatial/atrous.h"
#include "temporal/bases/coefficients.h"
#include "temporal/change/residual_cells.h"

namespace eigenlight {

struct CorrectionOptions {
  /// [0, 1000] variances of the smoothed residual that count as chance.
  float significance = 10.0f;
  int passes = 5;           ///< [1, 6] of the a-trous filter over cells that smooths the residual
  bool gated = true;        ///< filter only where light changes; else everywhere
  bool skip_planar = true;  ///< as in AtrousOptions

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// The smoothed innovation. The residual u - prediction has variance v (1/s + 1/n); averaged over
/// cells of 2 x 2 pixels, an edge-avoiding filter that looks at geometry only turns it into m with
/// variance q, and
///   correction = m f g,   f = max(0, 1 - significance * q / luminance(m)^2), averaged over
///   those of 3 x 3 cells that have a confirmed pixel,
/// is added to the prediction. A change of light that no basis explains is thus followed within
/// the frame, because it is smooth in space.
///
/// The gate g in [0, 1] opens where light changes. It grows with the share of 8 x 8 blocks, over a
/// coefficient tile and its neighbors, whose mean residual exceeds three standard deviations. It is
/// interpolated between tiles. Nothing is filtered where g is 0.
class Correction {
 public:
  /// `taps` say which pixels show the same surface. Throws std::invalid_argument on a bad size or
  /// option.
  Correction(Extent extent, const CorrectionOptions& options, const TapOptions& taps = {});

  /// Reads the geometry of `area` for the cells that the last frame needed. `area` starts at an
  /// even row and has an even height unless it ends with the image. Call it for the whole image
  /// before count_blocks(), in any order. Cells are written in groups of 8 (16 pixels): concurrent
  /// calls must not share a group.
  void read_geometry(const GBuffer& surface, const Rect& area);
  /// Tests the blocks of `area`, one or more blocks of 8 x 8 side by side, and fills the cells that
  /// the last frame needed. Call it for the whole image before prepare(), in any order, and again
  /// for blocks that change.
  void count_blocks(const CorrectionInputs& in, const Rect& area);
  /// Opens the gates, and fills the other cells that they need. CellFilter does the rest.
  void prepare(const CorrectionInputs& in);
  /// Share of the last frame's confirmed pixels that are corrected by more than half.
  [[nodiscard]] double share() const { return share_; }
  /// Zero where nothing is added.
  [[nodiscard]] const Planes<3>& correction() const { return correction_; }
  /// Whether the last frame may have corrected anything in a tile of the coefficients' grid.
  [[nodiscard]] bool is_open(int tile) const { return open_[tile] != 0; }
  /// g of a tile of the coefficients' grid in the last frame, [0, 1], even if filtering is not
  /// gated: how certain it is that its light changed in a way that no basis explains.
  [[nodiscard]] float change(int tile) const { return change_[tile]; }
  /// Pixels of the last frame in tiles that were not open: nothing was filtered there.
  [[nodiscard]] std::int64_t skipped() const { return skipped_; }

 private:
  friend class CellFilter;

  struct TileBlocks {
    int all = 0, significant = 0;
  };

  template <typename Body>
  void for_needed_cells(const Rect& area, const Body& body) const;
  void count_tiles();
  [[nodiscard]] bool open_gates();
  void close_tile(const Tile& tile);
  void choose_cells();
  struct WindowRow {
    float factor[kCoefficientTile], known[kCoefficientTile];
  };
  void find_factor(const Tile& cells);
  void sum_windows(int x0, int y, int count, WindowRow& sums) const;
  void weigh_cells(const Tile& cells);
  void weigh();

  CorrectionOptions options_;
  CoefficientField gate_;  // g - 1 per tile
  ResidualCells cells_;
  TileGrid grid_;  // of cells
  Planes<3> correction_;
  Plane<float> factor_;  // f of each cell
  TileGrid block_grid_;
  PerTile<ResidualBlock> blocks_;
  // Of coefficient tiles.
  PerTile<TileBlocks> tile_blocks_;
  PerTile<std::uint8_t> open_, was_open_;
  PerTile<float> change_;  // g
  // Of tiles of cells.
  PerTile<std::uint8_t> wanted_, loaded_, was_loaded_;
  PerTile<std::int64_t> corrected_;  // confirmed pixels
  std::int64_t skipped_ = 0;
  bool is_any_open_ = false;
  double share_ = 0.0;
};

/// A layer of light to be corrected.
struct CorrectionLayer {
  Correction& correction;
  const FrameInput& guides;
  Plane<float>& innovation;  ///< may be that of the inputs
};

/// The steps of Correction that all layers of light take together. They share what depends on the
/// geometry of cells, wherever they know the same cells; each gets the same bits as alone.
class CellFilter {
 public:
  /// `layers`: at least 1. Throws std::invalid_argument on a bad size or option.
  CellFilter(Extent pixels, const CorrectionOptions& options, int layers = 1);

  /// Once a frame, after prepare() of `layers`, 1 to the number given: computes their correction()
  /// and share(), and subtracts the luminance of correction() from the innovation.
  void correct(std::span<const CorrectionLayer> layers);

 private:
  using Layers = std::span<const CorrectionLayer>;

  void correct_some(Layers open);
  void spread(Layers open) const;
  void spread_row(Layers open, const Tile& area, std::uint8_t which) const;
  [[nodiscard]] std::uint8_t joined(const Tile& pixels) const;

  TileGrid cell_grid_;
  Atrous atrous_;
};

}  // namespace eigenlight
