// Reprojected bases, shared by the baselines.
#pragma once

#include <cstdint>

#include "frame/state.h"
#include "reproject/basis_field.h"
#include "reproject/surface_history.h"

namespace eigenlight {

/// How a history is reprojected.
struct HistoryOptions {
  /// Taps of age 0 are left out and the others share their weight; if false, they count as zeros.
  bool drops_empty_taps = false;
  /// If none of the four taps shows the pixel's surface, the pixel takes the mean of those of the
  /// 3 x 3 pixels around that show it and have an age above 0 (Schied 2017, section 4.1).
  bool widens = false;
};

/// Bases and ages of the last frame, with the surfaces and the camera of that frame.
class BasisHistory {
 public:
  struct Warp {
    bool cut = false;          ///< history was dropped
    std::int64_t skipped = 0;  ///< pixels not warped because nothing moved
  };

  /// Throws std::invalid_argument on a bad size or number of bases.
  BasisHistory(Extent extent, int bases, const HistoryOptions& options = {});

  /// Reprojects bases and ages to `frame` through validated taps. A frame that does not follow the
  /// one kept last is a cut: all values become 0. Throws std::invalid_argument if its size
  /// differs.
  [[nodiscard]] Warp warp(const FrameInput& frame);
  /// Keeps what the next warp() needs of `frame`. Call it after the bases are updated.
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
