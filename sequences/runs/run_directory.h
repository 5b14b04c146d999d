// The directory of a run and its checkpoint.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sequences/files/directory.h"
#include "temporal/denoiser.h"
#include "temporal/eigen/direct_denoiser.h"

namespace eigenlight {

/// What a run has of history: its denoisers. `direct` is null where direct light stays noisy.
struct RunHistory {
  Denoiser& indirect;
  DirectDenoiser* direct = nullptr;
};

/// Holds frame.####.exr, frames.jsonl, run.json, index.html, and state.bin, the checkpoint that
/// `--resume` starts from.
class RunDirectory {
 public:
  /// Makes the directory and locks it. `run` is to_json_text() of the run. Throws
  /// std::runtime_error naming the directory if it cannot be made, or if another run is writing
  /// into it.
  RunDirectory(std::filesystem::path path, std::string run);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// A line on frames of another run, beside `frames` of this one; empty if there are none.
  [[nodiscard]] std::string foreign_frames(const std::vector<int>& frames) const;

  /// Starts a new run: removes the checkpoint of an older run and writes run.json. Frames of an
  /// older run stay until frames of this run overwrite them.
  void begin() const;

  /// Resumes the run from its checkpoint: loads `history` and returns how many of `frames` are
  /// complete. Without a checkpoint, and with run.json missing or of this run, it calls begin() and
  /// returns 0. Throws CheckpointError if the checkpoint is damaged, of another version or of
  /// another run, or if a frame that it counts as complete is missing.
  [[nodiscard]] std::size_t resume(const std::vector<int>& frames, const RunHistory& history) const;

  /// Writes the checkpoint after `position` complete frames.
  void save(std::size_t position, const RunHistory& history) const;

 private:
  void check_same_run(const std::filesystem::path& file, const std::string& there) const;

  std::filesystem::path path_;
  std::string run_;
  std::unique_ptr<DirectoryLock> lock_;
};

}  // namespace eigenlight
