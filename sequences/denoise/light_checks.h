// Checks of light before a run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sequences/denoise/find_readings.h"

namespace eigenlight {

/// Lines for people on light that cannot become what they expect: denoised already, noise that is
/// the same in all frames or correlated, an albedo noisier than light (checks.h). Luminance is that
/// of the file's chromaticities. `guides`: raw_guides() of each frame.
[[nodiscard]] std::vector<std::string> check_lights(std::span<const RawFrame> frames,
                                                    const ViewPlan& view,
                                                    std::span<const RawGuides> guides,
                                                    const Readings& readings);

/// Whether motion vectors are colors: all of 0 to 1, most of them near 0.5, which stands for 0.
[[nodiscard]] bool are_encoded(std::span<const RawGuides> guides);

}  // namespace eigenlight
