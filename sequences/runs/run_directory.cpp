#include "sequences/runs/run_directory.h"

#include <fmt/format.h>

#include <algorithm>

#include "sequences/files/atomic_file.h"
#include "sequences/files/checkpoint.h"
#include "sequences/files/file_pattern.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/sequence_name.h"
#include "sequences/runs/run_description.h"

namespace eigenlight {
namespace {

constexpr std::string_view kCheckpointFile = "state.bin";
constexpr std::string_view kRunFile = "run.json";

}  // namespace

RunDirectory::RunDirectory(std::filesystem::path path, std::string run)
    : path_(std::move(path)), run_(std::move(run)) {
  make_directory(path_);
  lock_ = std::make_unique<DirectoryLock>(path_);
}

std::string RunDirectory::foreign_frames(const std::vector<int>& frames) const {
  const std::filesystem::path file = path_ / kRunFile;
  std::error_code error;
  if (std::filesystem::exists(file, error) && read_whole_file(file) == run_) return {};
  std::vector<int> others;
  for (const int frame : SequenceName((path_ / kFramePattern).string()).frames()) {
    if (std::find(frames.begin(), frames.end(), frame) == frames.end()) others.push_back(frame);
  }
  if (others.empty()) return {};
  return fmt::format("{}: holds {} frames of another run beside those of this one: {}",
                     path_.string(), others.size(), format_frame_range(others));
}

void RunDirectory::begin() const {
  const std::filesystem::path state = path_ / kCheckpointFile;
  std::error_code error;
  std::filesystem::remove(state, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: cannot remove: {}", state.string(), error.message()));
  }
  write_file_atomically(path_ / kRunFile, run_);
}

void RunDirectory::check_same_run(const std::filesystem::path& file,
                                  const std::string& there) const {
  std::string difference;
  try {
    difference = first_difference(there, run_);
  } catch (const std::runtime_error& error) {
    throw CheckpointError(fmt::format("{}: {}", file.string(), error.what()));
  }
  if (!difference.empty()) {
    throw CheckpointError(fmt::format("{}: of another run: {}", file.string(), difference));
  }
}

std::size_t RunDirectory::resume(const std::vector<int>& frames, const RunHistory& history) const {
  const std::filesystem::path state = path_ / kCheckpointFile;
  if (!std::filesystem::exists(state)) {
    const std::filesystem::path run = path_ / kRunFile;
    if (std::filesystem::exists(run)) check_same_run(run, read_whole_file(run));
    begin();
    return 0;
  }
  const Checkpoint checkpoint = read_checkpoint(state);
  check_same_run(state, checkpoint.run);
  if (checkpoint.position > frames.size()) {
    throw CheckpointError(fmt::format("{}: {} frames complete, but the run has {}", state.string(),
                                      checkpoint.position, frames.size()));
  }
  const FilePattern pattern(kFramePattern);
  for (std::size_t i = 0; i < checkpoint.position; ++i) {
    const std::filesystem::path file = path_ / pattern.name(frames[i]);
    check_complete(state, frames[i], {&file, 1});
  }
  restore_state(state, checkpoint, [&](StateReader& reader) {
    history.indirect.load(reader);
    if (history.direct) history.direct->load(reader);
  });
  write_file_atomically(path_ / kRunFile, run_);
  return checkpoint.position;
}

void RunDirectory::save(std::size_t position, const RunHistory& history) const {
  StateWriter state;
  history.indirect.save(state);
  if (history.direct) history.direct->save(state);
  write_checkpoint(path_ / kCheckpointFile, {run_, position, state.bytes()});
}

}  // namespace eigenlight
