// What all layers of light of a frame share: its surfaces, where each pixel was, and which pixels
// get extra samples.
#pragma once

#include "reproject/surface_history.h"
#include "temporal/eigen/eigen_options.h"
#include "temporal/samples/pixel_counts.h"

namespace eigenlight {

/// The current frame, and its geometry, which is computed once for all layers of light.
class SharedFrame {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  SharedFrame(Extent extent, const EigenOptions& options);

  /// Reads the next frame from `source`; the last one becomes history. False at the end of the
  /// sequence. Throws std::invalid_argument on a frame of another size or number of layers.
  [[nodiscard]] bool read(FrameSource& source, int layers);
  /// Counts the surfaces of a row of a tile. Those without usable guides lose their geometry
  /// (frame/guides.h).
  void check_surfaces(const Tile& row);
  /// Finds where the pixels of a row were in the last frame, and which of them lie at edges.
  void find_taps(const Tile& row, TapSegment& taps);
  /// Plans extra samples for the pixels of low `age` (sample_budget.h). Returns how many.
  [[nodiscard]] std::int64_t plan_samples(const Plane<float>& age);
  /// Ends the work on the current frame. The caller may read it until the next read().
  void finish() { is_finished_ = true; }
  /// Forgets the surfaces of the frame before, as at a cut.
  void reset();

  [[nodiscard]] Frame& frame() { return frame_; }
  [[nodiscard]] const Frame& frame() const { return frame_; }
  [[nodiscard]] const TileGrid& tiles() const { return tiles_; }  ///< of coefficients
  /// History does not lead to this frame.
  [[nodiscard]] bool is_cut() const { return is_cut_; }
  /// History lies where it was: neither camera nor objects have moved.
  [[nodiscard]] bool is_still() const { return is_still_; }
  /// History is warped.
  [[nodiscard]] bool is_moving() const { return !is_cut_ && !is_still_; }
  /// No pixel of the tile has a surface, and such tiles are skipped.
  [[nodiscard]] bool is_empty(const Tile& tile) const {
    return options_.skip_empty && counts_[tile].surface == 0;
  }
  [[nodiscard]] const PerTile<PixelCounts>& counts() const { return counts_; }
  /// edge() holds those of this frame: 1 at edges whose history is blended (edges.h).
  [[nodiscard]] bool has_edges() const { return has_edges_; }
  [[nodiscard]] const Plane<std::uint8_t>& edge() const { return edge_; }
  [[nodiscard]] const Plane<std::uint8_t>& extra() const { return extra_; }  ///< samples planned

  /// The surfaces that the next frame's history comes from.
  void save(StateWriter& out) const;
  void load(StateReader& in);

 private:
  EigenOptions options_;
  TileGrid tiles_;
  Frame frame_;
  bool is_finished_ = false;  // frame_ is history that surfaces_ has not taken over yet
  bool is_cut_ = true, is_still_ = false, has_edges_ = false;
  SurfaceHistory surfaces_;
  PerTile<PixelCounts> counts_;
  SampleBudget budget_;
  Plane<std::uint8_t> edge_, extra_;
};

}  // namespace eigenlight
