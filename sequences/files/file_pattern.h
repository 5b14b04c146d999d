// File names with a frame number in them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace eigenlight {

/// A file name with one place for the frame number: `#` stands for four digits, `##` and longer for
/// as many digits as signs, each `@` for one digit, `%d` and `%04d` are as in printf. Longer
/// numbers are written in full; a minus sign counts as a digit, as in printf.
class FilePattern {
 public:
  /// Throws std::invalid_argument unless `text` has exactly one such place.
  explicit FilePattern(std::string_view text);

  /// The name of one frame: `frame.####.exr` and 12 give `frame.0012.exr`.
  [[nodiscard]] std::string name(int frame) const;
  /// The frame number in a name, or nothing if name() gives that name for no frame.
  [[nodiscard]] std::optional<int> frame(std::string_view name) const;

 private:
  std::string before_, after_;
  int digits_ = 1;
};

/// Names of the frames of a run.
inline constexpr std::string_view kFramePattern = "frame.####.exr";

}  // namespace eigenlight
