// Lists of frame numbers as users write them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace eigenlight {

/// Frames of `text` in the order written: a comma-separated list of `7`, `1-10`, `5-1` (backwards)
/// and `1-100x5` (every fifth); numbers may be negative (`-10-100`). Throws std::invalid_argument
/// naming the part that has none of these forms, a frame named twice, a number beyond +-10,000,000,
/// or more than 1,000,000 frames.
[[nodiscard]] std::vector<int> parse_frame_range(std::string_view text);

/// A short text of that form: neighbors at equal steps become a range.
[[nodiscard]] std::string format_frame_range(const std::vector<int>& frames);

}  // namespace eigenlight
