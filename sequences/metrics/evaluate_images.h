// The images of one frame that is to be measured.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "sequences/metrics/evaluate.h"
#include "sequences/metrics/metrics.h"

namespace eigenlight {

struct FramePaths {
  std::filesystem::path test, reference;
  std::filesystem::path reference_b;  ///< empty: none
  /// What the layers begin with in the test, the reference and the second reference.
  std::array<std::string, 3> prefixes;
};

struct LoadedFrame {
  MetricFrame images;  ///< bits are filled; pixels with NaN or Inf lack kFiniteBit
  std::int64_t bad_pixels = 0;
  std::string bad;                  ///< one line on the first file with NaN or Inf, or empty
  std::optional<int> step;          ///< first frame of a light step, as the files have it
  std::int64_t outside_pixels = 0;  ///< outside of the data window of a file; not kFiniteBit
  std::string surface_from, age_from;
  std::string note;  ///< on colors of other primaries, or empty
};

/// Reads the files of one frame. Throws std::runtime_error naming the file that is missing, cannot
/// be read, lacks the layer, or has another size than the test.
[[nodiscard]] LoadedFrame load_frame(int frame, const FramePaths& paths,
                                     const EvaluateOptions& options);

}  // namespace eigenlight
