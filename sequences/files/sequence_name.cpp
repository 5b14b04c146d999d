#include "sequences/files/sequence_name.h"

#include <algorithm>
#include <utility>

namespace eigenlight {

namespace fs = std::filesystem;

SequenceName::SequenceName(std::string text) : text_(std::move(text)) {
  const std::string name = fs::path(text_).filename().string();
  std::error_code error;
  if (name.find_first_of("#@%") == std::string::npos || fs::is_regular_file(text_, error)) return;
  pattern_.emplace(name);
}

fs::path SequenceName::path(int frame) const {
  return pattern_ ? fs::path(text_).replace_filename(pattern_->name(frame)) : fs::path(text_);
}

std::vector<int> SequenceName::frames() const {
  std::vector<int> frames;
  if (!pattern_) return frames;
  const fs::path parent = fs::path(text_).parent_path();
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(parent.empty() ? "." : parent, error)) {
    if (const auto frame = pattern_->frame(entry.path().filename().string())) {
      frames.push_back(*frame);
    }
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

bool is_exr_name(const std::filesystem::path& name) {
  std::string end = name.extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == ".exr";
}

}  // namespace eigenlight
