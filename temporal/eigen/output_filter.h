// Spatial filters of one layer's output.
#pragma once

#include "frame/ping_pong.h"
#include "frame/state.h"
#include "temporal/eigen/eigen_options.h"

namespace eigenlight {

struct FilterInputs {
  const FrameInput& frame;
  const Plane<float>& age;           ///< with this frame
  const Plane<std::uint8_t>& young;  ///< 1 where age is below EigenOptions::young_age
};

/// What a layer of light needs to be filtered. Young pixels take the value of the guided filter
/// (Bauszat 2011). The a-trous passes that follow (atrous.h) filter all layers at once; they find
/// edges of light in the last picture as well, which is brought to this frame through the taps of
/// the history. Calls per frame: start_warp() and warp() of all rows if anything moved,
/// fill_young(), earlier(), and keep() after the passes.
class OutputFilter {
 public:
  OutputFilter(Extent extent, const EigenOptions& options);

  void start_warp() { shown_.swap(); }
  /// Brings the luminance of the last picture to a row of this frame.
  void warp(const TapSegment& taps, const Rect& row);
  /// Blends young pixels of the estimate with the guided filter's value, which has the weight 1 -
  /// age / young_age, and lowers their variance. Returns the pixels in tiles without young ones.
  std::int64_t fill_young(const FilterInputs& in, Planes<3>& output, Plane<float>& variance);
  /// The luminance of the last picture for the a-trous passes, NaN at new pixels, whose `old_age`
  /// is 0. Null if the passes do not look back.
  [[nodiscard]] const Plane<float>* earlier(const Plane<float>& old_age);
  /// Keeps the luminance of this picture for the next frame.
  void keep(const Planes<3>& picture);

  void save(StateWriter& out) const { out.plane("shown light", shown_.now); }
  /// Throws std::runtime_error where StateReader does.
  void load(StateReader& in) { in.plane("shown light", shown_.now); }

 private:
  EigenOptions options_;
  bool looks_back_;  // there are passes, and they do
  TileGrid tiles_;
  GuidedFilter guided_;
  Planes<3> guided_light_;
  PingPong<Plane<float>> shown_;  // luminance of the last picture, brought to this frame
};

}  // namespace eigenlight
