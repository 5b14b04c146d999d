// Image sequences on disk against their references.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sequences/metrics/lag.h"
#include "sequences/metrics/metrics.h"

namespace eigenlight {

/// What to compare. File names are patterns (file_pattern.h), or plain names for one image. Behind
/// a colon may stand what layer names begin with: of `ref.####.exr:HalfA` the layers `HalfA.*`.
struct EvaluateOptions {
  std::string test;
  std::string reference;
  std::string reference_b;  ///< second, independent reference; empty: none
  /// Of the references; absent: `indirect`, or the beauty of files that have none.
  std::optional<std::string> layer;
  std::optional<std::string> test_layer;  ///< of the test; the same as `layer` if absent
  std::string frames;                     ///< frame_range.h; empty: all that any sequence has
  /// First frame of a light step; absent: as the file of the first frame has it
  /// (`eigenlight.perturb`), in the test, else in the reference.
  std::optional<int> step;
  bool takes_all_pixels = false;  ///< whatever the files know of surfaces
  bool skips_bad = false;         ///< leave bad frames and pixels out, and count them
  MetricOptions metrics;          ///< is_display is set by the file names
};

/// Something that was left out on request.
struct Skipped {
  int frame = 0;
  std::string reason;  ///< names the file
};

struct Evaluation {
  std::vector<FrameFigures> frames;
  SetFigures mean;
  std::vector<Skipped> skipped;     ///< frames
  std::int64_t bad_pixels = 0;      ///< with NaN or Inf, left out of frames that were measured
  std::int64_t outside_pixels = 0;  ///< left out: outside of the data window of a file
  MetricOptions metrics;            ///< as used
  std::optional<int> step;          ///< first frame of a light step, as given or as found
  std::optional<Lag> lag;  ///< over `frames`; absent if there is no step to be seen in them
  /// Where the pixel sets come from: `test id`, or `all pixels`; where frames differ, with them:
  /// `test Z in frames 1-2, all pixels in 3-4`.
  std::string surface_from;
  std::string age_from;            ///< `test age`, or empty: no young and old pixels
  std::vector<std::string> notes;  ///< lines for people: what the figures do not tell
};

/// Matches the sequences by frame number and measures each frame. Surfaces are where the layer `id`
/// is not 0, else where `Z` is finite and below 1e10 (what Cycles writes for the background); from
/// the test, else from the first reference, else all pixels count. Ages are the layer `age`, found
/// the same way. Pixels outside of the data window of any file count nowhere. Layers of one channel
/// are gray. Colors are compared as the numbers that they are: that primaries differ is noted. PNG
/// and JPEG hold display values and have no layers; they compare with their like.
///
/// Temporal figures compare neighbors: frames as far apart as the nearest two of the list.
///
/// Bad: a missing or unreadable file, a missing layer, images of different size, pixels with NaN or
/// Inf. Throws std::runtime_error with one line that names the file of the first bad frame and
/// counts the others that are missing, unless skips_bad; also if no frame is left, or if no light
/// step is seen where options.step says. It is a BadFile unless the file may come later or become
/// whole. Throws std::invalid_argument on options that do not fit
/// together.
[[nodiscard]] Evaluation evaluate(const EvaluateOptions& options);

}  // namespace eigenlight
