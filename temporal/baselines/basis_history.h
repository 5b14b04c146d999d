// Bases that follow their surfaces from frame to frame: what the baselines have in common.
#pragma once

#include <cstdint>

#include "frame/state.h"
#include "reproject/basis_field.h"
#include "reproject/surface_history.h"

namespace eigenlight {

/// How a history is carried over.
struct HistoryOptions {
  /// Taps of age 0 give nothing, the others share their weight; otherwise they count as zeros.
  bool drops_empty_taps = false;
  /// A pixel none of whose four taps shows its surface takes the mean of those of the 3 x 3 pixels
  /// around that do and are not of age 0 (SVGF, section 4.1).
  bool widens = false;
};

/// Bases and ages as the last frame saw them, with the surfaces and the camera of that frame.
class BasisHistory {
 public:
  struct Warp {
    bool cut = false;          ///< history was dropped
    std::int64_t skipped = 0;  ///< pixels left as they are since nothing moved
  };

  /// Throws std::invalid_argument on a bad size or number of bases.
  BasisHistory(Extent extent, int bases, const HistoryOptions& options = {});

  /// Carries bases and ages over to `frame` through validated taps. All become 0 at a cut, which is
  /// a frame that does not follow the one kept last. Throws std::invalid_argument if its size
  /// differs.
  [[nodiscard]] Warp warp(const FrameInput& frame);
  /// Takes what the next warp() has to know of `frame`. The bases are to be updated by then.
  void keep(const FrameInput& frame) { surfaces_.keep(frame); }
  void reset() { surfaces_.reset(); }  ///< the next warp() is a cut

  [[nodiscard]] Extent extent() const { return bases_.extent(); }
  [[nodiscard]] BasisField& bases() { return bases_; }
  [[nodiscard]] const BasisField& bases() const { return bases_; }

  /// load() throws std::runtime_error when the state has another size or number of bases.
  void save(StateWriter& out) const;
  void load(StateReader& in);

 private:
  void warp_row(const FrameInput& frame, const PreviousSurface& previous, const Rect& row);
  void widen(const FrameInput& frame, const PreviousSurface& previous, glm::ivec2 pixel);

  HistoryOptions options_;
  TapOptions taps_;
  SurfaceHistory surfaces_;
  BasisField bases_, warped_;
};

}  // namespace eigenlight
