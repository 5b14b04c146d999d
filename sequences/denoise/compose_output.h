// From denoised layers of light to the channels that files get.
#pragma once

#include <span>
#include <vector>

#include "sequences/denoise/raw_frame.h"
#include "sequences/exr/exr_rewrite.h"

namespace eigenlight {

/// A channel of an input's file with its new values.
struct NewChannel {
  int channel = 0;      ///< of ExrFile::channels()
  Plane<float> values;  ///< of the channel's data window
};

/// As rewrite_exr() takes them; they refer to `channels`.
[[nodiscard]] std::vector<ExrReplacement> replacements_of(std::span<const NewChannel> channels);

/// The new channels of a frame, for each input. `lights` are the denoised layers of a view in the
/// order of its plan: light over its color, on the canvas. `emission`: what ViewPlan::emission
/// became, or none of it; where it is NaN the file's value stays.
///
/// A layer of light is written as the file has it: with its color, or without. A sum is written as
/// the sum of its parts,
///   beauty = sum of (color * light) + emission,
/// so that parts still add up to it. What it had beyond its parts is left out where it is no more
/// than rounding (kRoundingAbsolute of the parts), and passes else.
void compose_view(const RawFrame& frame, const ViewPlan& view, const ExrWindow& canvas,
                  std::span<const Planes<3>* const> lights,
                  std::span<const Planes<3>* const> emission,
                  std::vector<std::vector<NewChannel>>& outputs);

}  // namespace eigenlight
