// What the numbers of a file mean as colors.
#pragma once

#include <array>

#include "sequences/exr/exr_file.h"

namespace eigenlight {

/// Weights of red, green and blue in luminance: the row Y of the matrix from RGB to XYZ,
///   Y = w_R R + w_G G + w_B B, white has Y = 1
/// (SMPTE RP 177-1993). Those of Rec. 709 where primaries lie on one line, or white outside of what
/// they can show.
[[nodiscard]] std::array<double, 3> luminance_weights(const ExrChromaticities& primaries);

/// The primaries and white of Rec. 709, which files without the attribute have.
[[nodiscard]] ExrChromaticities rec709_chromaticities();

/// Whether two files mean the same colors: within 0.001, as writers round.
[[nodiscard]] bool same_colors(const ExrChromaticities& a, const ExrChromaticities& b);

}  // namespace eigenlight
