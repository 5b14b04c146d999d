// From the estimate of each pixel to the picture: what surroundings and the last picture know.
#pragma once

#include "frame/state.h"
#include "temporal/eigen/eigen_options.h"

namespace eigenlight {

struct FilterInputs {
  const FrameInput& frame;
  const Plane<float>& old_age;       ///< of the history, 0: the pixel is new
  const Plane<float>& age;           ///< with this frame
  const Plane<std::uint8_t>& young;  ///< 1 where age is below EigenOptions::young
};

/// Pixels left alone.
struct FilterReport {
  std::int64_t guided = 0;    ///< in tiles without young pixels
  std::int64_t atrous = 0;    ///< already quiet enough
  std::int64_t geometry = 0;  ///< in one plane with all taps
};

/// Young pixels lean on what their surroundings say of such a surface (Bauszat 2011); then a-trous
/// passes (atrous.h), which tell edges of light by the last picture as well, brought here through
/// the taps of the history. For that, keep() or warp() of all rows comes before process() in each
/// frame but the first.
class OutputFilter {
 public:
  OutputFilter(Extent extent, const EigenOptions& options);

  /// Nothing has moved since the last picture.
  void keep() { std::swap(shown_, earlier_); }
  /// What the last picture showed of a row of this frame.
  void warp(const TapSegment& taps, const Tile& row);
  /// Filters the estimate in place, and the variance of its luminance.
  FilterReport process(const FilterInputs& in, Planes<3>& output, Plane<float>& variance);

  void save(StateWriter& out) const { out.plane("shown light", shown_); }
  /// Throws std::runtime_error where StateReader does.
  void load(StateReader& in) { in.plane("shown light", shown_); }

 private:
  std::int64_t fill_young(const FilterInputs& in, Planes<3>& output, Plane<float>& variance);
  void forget_new(const Plane<float>& old_age);

  EigenOptions options_;
  bool looks_back_;  // there are passes, and they do
  TileGrid tiles_;
  GuidedFilter guided_;
  Atrous atrous_;
  Planes<3> guided_light_;
  Plane<float> shown_, earlier_;  // luminance of the last picture, and brought to this frame
};

}  // namespace eigenlight
