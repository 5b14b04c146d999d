// The files of a sequence: what is read and what is written for each frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eigenlight {

/// What the user says about files.
struct FileChoice {
  std::vector<std::string> inputs;  ///< patterns, or names of files
  std::string output;               ///< a pattern, a file or a folder
  std::string frames;               ///< as parse_frame_range() takes them; empty: all that exist
  bool overwrite = false;           ///< an output may be an input
};

/// One frame: for each input the file that is read, and the one that is written.
struct FrameFiles {
  int frame = 0;
  std::vector<std::filesystem::path> inputs, outputs;
};

/// Resolves patterns. A name of a file that exists is that file, whatever signs it holds; a single
/// file without a place for a number is frame 1. An output is a folder, where files keep the names
/// of the inputs, unless it ends with `.exr`.
///
/// Throws std::invalid_argument if a pattern has no place for the frame number, an output is an
/// input and `overwrite` is false, two frames have one output, an output is neither a folder nor a
/// name of an EXR file, or several inputs have an output that is no folder; BadFile if no file has
/// such a name; std::runtime_error naming the first frame that is missing from a sequence, which
/// may still be rendered.
[[nodiscard]] std::vector<FrameFiles> find_sequence(const FileChoice& choice);

}  // namespace eigenlight
