// What a motion layer means: sign, unit, axes, direction.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "frame/plane.h"
#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

/// What the vectors of a file mean. (scale_x * mx, scale_y * my) is in pixels, x right and y down,
/// and leads from where a point is seen in the later frame to where it was in the earlier one.
struct MotionReading {
  int pair = 0;                          ///< 0: the first two channels; 1: the third and fourth
  double scale_x = 1.0, scale_y = -1.0;  ///< pixels per unit, with sign
  /// The vector belongs to the pixel of the later of both frames. Else to that of the earlier one:
  /// the file of frame t holds what happens between t and t + 1.
  bool backward = true;

  friend bool operator==(const MotionReading&, const MotionReading&) = default;
};

/// Readings compared. A residual is a share: 0 where all that is compared matches, about 1 where
/// nothing does (reprojection.h).
struct MotionFit {
  MotionReading best, next;  ///< next: the best of the readings that lead elsewhere
  double residual = 1.0, next_residual = 1.0, still_residual = 1.0;  ///< still: as if nothing moved
  bool is_clear = false;
  std::string words;  ///< one line for people
};

/// Least ratio of the next residual to the best one, over the pixels where both lead to different
/// places, for a reading to be clear. See README.md.
inline constexpr double kClearRatio = 1.5;

/// Tries the readings on two to four successive frames: signs, pixels, uv (0 to 1), NDC (-1 to 1),
/// a fitted scale (vectors that are scaled by the shutter), first or second pair, backward or
/// forward. A reading is good where depth (relative), normal and albedo are found again at the end
/// of its vectors. Changes of depth that any move of the camera brings are left out of the
/// comparison, so no camera is needed. Readings that lead to the same places within half a pixel
/// count as one, but a sign or a unit that the frames do not tell is not clear. Throws
/// std::invalid_argument if extents differ.
[[nodiscard]] MotionFit find_motion(std::span<const RawGuides> frames);

/// The reading named by a preset (cycles, arnold, renderman, vray, optix; none: nullopt) or by
/// words between commas, in any order: x or -x, y or -y (sign in pixels, y down: what leads from
/// the later to the earlier place), pixels, uv, ndc, pixels per unit as a number (8) or pictures
/// per unit
/// (.5uv), backward or forward, first or second. Left out: x, y, pixels, backward, first. `extent`
/// turns uv and ndc into pixels. Throws std::invalid_argument with the list.
[[nodiscard]] std::optional<MotionReading> parse_motion(std::string_view text, Extent extent);

/// The text that parse_motion() reads as `reading`.
[[nodiscard]] std::string format_motion(const MotionReading& reading, Extent extent);

}  // namespace eigenlight
