// From the estimate of each pixel to the picture: what surroundings and the last picture know.
#pragma once

#include "frame/ping_pong.h"
#include "frame/state.h"
#include "temporal/eigen/eigen_options.h"

namespace eigenlight {

struct FilterInputs {
  const FrameInput& frame;
  const Plane<float>& old_age;       ///< of the history, 0: the pixel is new
  const Plane<float>& age;           ///< with this frame
  const Plane<std::uint8_t>& young;  ///< 1 where age is below EigenOptions::young_age
};

/// Young pixels take the value of the guided filter (Bauszat 2011); then come a-trous passes
/// (atrous.h), which find edges of light in the last picture as well, brought to this frame through
/// the taps of the history. Calls per frame: start_warp() and warp() of all rows if anything moved,
/// fill_young(), find_noisy(), process().
class OutputFilter {
 public:
  OutputFilter(Extent extent, const EigenOptions& options);

  void start_warp() { shown_.swap(); }
  /// Brings the luminance of the last picture to a row of this frame.
  void warp(const TapSegment& taps, const Rect& row);
  /// Gives young pixels of the estimate the guided filter's value in the share that their age lacks
  /// of young_age; their variance falls with it. Returns the pixels in tiles without young ones.
  std::int64_t fill_young(const FilterInputs& in, Planes<3>& output, Plane<float>& variance);
  /// The tiles of stage_tiles() that the a-trous passes filter, 1 each.
  [[nodiscard]] const PerTile<std::uint8_t>& find_noisy(const FrameInput& frame,
                                                        const Planes<3>& output,
                                                        const Plane<float>& variance);
  /// Filters the estimate in place, and the variance of its luminance. `planes` are the frame's.
  /// Returns the surface pixels that were quiet enough to be skipped.
  std::int64_t process(const FilterInputs& in, const PlanarBlocks& planes, Planes<3>& output,
                       Plane<float>& variance);

  void save(StateWriter& out) const { out.plane("shown light", shown_.now); }
  /// Throws std::runtime_error where StateReader does.
  void load(StateReader& in) { in.plane("shown light", shown_.now); }

 private:
  void forget_new(const Plane<float>& old_age);

  EigenOptions options_;
  bool looks_back_;  // there are passes, and they do
  TileGrid tiles_;
  GuidedFilter guided_;
  Atrous atrous_;
  Planes<3> guided_light_;
  PingPong<Plane<float>> shown_;  // luminance of the last picture, brought to this frame
};

}  // namespace eigenlight
