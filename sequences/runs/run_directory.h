// The directory of a run: what is in it before the first frame, and its checkpoint.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sequences/runs/output.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// frame.####.exr, frames.jsonl, run.json, index.html, and state.bin, the checkpoint that
/// `--resume` starts from.
class RunDirectory {
 public:
  /// `run` is to_json_text() of the run. Makes the directory. Throws std::runtime_error naming it
  /// if that cannot be.
  RunDirectory(std::filesystem::path path, std::string run);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Starts anew: removes the checkpoint of an older run, writes run.json. Frames of an older run
  /// are overwritten one by one, and those that this run does not have stay.
  void begin() const;

  /// Takes up the run where its checkpoint left it: loads `denoiser`, and returns how many of
  /// `frames` are complete. 0 where there is no checkpoint and run.json is missing or of this run;
  /// then it begins anew. Throws CheckpointError if the checkpoint is damaged, of another version
  /// or another run, or if a frame that it counts as complete is missing.
  [[nodiscard]] std::size_t resume(const std::vector<int>& frames, Denoiser& denoiser) const;

  /// Writes the checkpoint after `position` complete frames.
  void save(std::size_t position, const Denoiser& denoiser) const;

 private:
  void check_same_run(const std::filesystem::path& file, const std::string& there) const;

  std::filesystem::path path_;
  std::string run_;
};

}  // namespace eigenlight
