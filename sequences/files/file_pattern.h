// File names with a frame number in them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace eigenlight {

/// A file name with one place for the frame number: `#` is four digits, a longer run of `#` its
/// length, each `@` one digit, `%d` and `%04d` as in printf. Longer numbers are written in full; a
/// minus sign counts as a digit, as printf has it.
class FilePattern {
 public:
  /// Throws std::invalid_argument if `text` has no such place, or more than one.
  explicit FilePattern(std::string_view text);

  /// The name of one frame: `frame.####.exr` and 12 give `frame.0012.exr`.
  [[nodiscard]] std::string name(int frame) const;
  /// The frame of a name, or nothing if the pattern does not give that name for any frame.
  [[nodiscard]] std::optional<int> frame(std::string_view name) const;

 private:
  std::string before_, after_;
  int digits_ = 1;
};

/// The frames of a run in its directory.
inline constexpr std::string_view kFramePattern = "frame.####.exr";

}  // namespace eigenlight
