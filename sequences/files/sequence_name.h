// Names of sequences of files as users write them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sequences/files/file_pattern.h"

namespace eigenlight {

/// A sequence of files whose names hold the frame number (FilePattern, in the last part of the
/// path), or one file. The name of a file that exists is that file, whatever signs it holds.
class SequenceName {
 public:
  /// Throws std::invalid_argument if the name has more than one place for the frame number.
  explicit SequenceName(std::string text);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] bool is_single() const { return !pattern_; }
  /// The file of a frame; of a single file, that file.
  [[nodiscard]] std::filesystem::path path(int frame) const;
  /// Numbers of the files that exist, rising. None for a single file.
  [[nodiscard]] std::vector<int> frames() const;

 private:
  std::string text_;
  std::optional<FilePattern> pattern_;  // of the last part of the path
};

/// Whether a name ends in .exr, in any case.
[[nodiscard]] bool is_exr_name(const std::filesystem::path& name);

}  // namespace eigenlight
