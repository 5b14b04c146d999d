#include "sequences/denoise/sequence_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>

#include "frame/bad_file.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/sequence_name.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

std::vector<int> existing_frames(const SequenceName& input) {
  if (input.is_single()) return {1};
  std::vector<int> frames = input.frames();
  if (frames.empty()) throw BadFile(fmt::format("{}: no such files", input.text()));
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (frames[i] == frames[i - 1] + 1) continue;
    // Sequences at a regular step are one shot; a hole is most often a lost file.
    const int step = frames[1] - frames[0];
    if (frames[i] - frames[i - 1] == step) continue;
    throw std::runtime_error(fmt::format(
        "{}: frame {} is missing; name the frames with --frames {}",
        input.path(frames[i - 1] + 1).string(), frames[i - 1] + 1, format_frame_range(frames)));
  }
  return frames;
}

// A frame of a sequence may come later, unless nothing of that name can: then the name is wrong.
[[noreturn]] void fail_missing(const SequenceName& input, int frame) {
  const fs::path path = input.path(frame);
  const std::string line = fmt::format("{}: no such file", path.string());
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (input.is_single() || !fs::is_directory(folder, error)) throw BadFile(line);
  throw std::runtime_error(line);
}

fs::path real(const fs::path& path) {
  std::error_code error;
  const fs::path full = fs::weakly_canonical(path, error);
  return error ? fs::absolute(path).lexically_normal() : full;
}

void check_outputs(const std::vector<FrameFiles>& frames, bool overwrite) {
  std::set<fs::path> inputs, outputs;
  for (const FrameFiles& frame : frames) {
    for (const fs::path& path : frame.inputs) inputs.insert(real(path));
  }
  for (const FrameFiles& frame : frames) {
    for (const fs::path& path : frame.outputs) {
      if (!outputs.insert(real(path)).second) {
        throw std::invalid_argument(
            fmt::format("-o: {} would be written twice; expected a name for each frame and input",
                        path.string()));
      }
      if (!overwrite && inputs.count(real(path)) > 0) {
        throw std::invalid_argument(fmt::format(
            "-o: {} is an input; choose another folder, or say --overwrite", path.string()));
      }
    }
  }
}

}  // namespace

std::vector<FrameFiles> find_sequence(const FileChoice& choice) {
  const std::vector<SequenceName> inputs(choice.inputs.begin(), choice.inputs.end());
  const bool to_file = is_exr_name(choice.output);
  if (to_file && inputs.size() > 1) {
    throw std::invalid_argument(
        fmt::format("-o {}: expected a folder, for there are several inputs", choice.output));
  }
  std::error_code ignored;
  if (!to_file && fs::exists(choice.output, ignored) && !fs::is_directory(choice.output, ignored)) {
    throw std::invalid_argument(fmt::format(
        "-o {}: is a file, expected a folder or a name that ends in .exr", choice.output));
  }
  std::optional<SequenceName> output;
  if (to_file) output.emplace(choice.output);
  const std::vector<int> frames =
      choice.frames.empty() ? existing_frames(inputs.front()) : parse_frame_range(choice.frames);
  std::vector<FrameFiles> sequence;
  for (const int frame : frames) {
    FrameFiles paths;
    paths.frame = frame;
    for (const SequenceName& input : inputs) {
      const fs::path in = input.path(frame);
      std::error_code error;
      if (!fs::exists(in, error)) fail_missing(input, frame);
      paths.inputs.push_back(in);
      paths.outputs.push_back(output ? output->path(frame)
                                     : fs::path(choice.output) / in.filename());
    }
    sequence.push_back(std::move(paths));
  }
  check_outputs(sequence, choice.overwrite);
  return sequence;
}

}  // namespace eigenlight
