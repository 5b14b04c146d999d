// The checkpoint of a run: its state between two frames, in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "frame/bad_file.h"
#include "frame/state.h"

namespace eigenlight {

/// A checkpoint that must not be used.
class CheckpointError : public BadFile {
 public:
  using BadFile::BadFile;
};

struct Checkpoint {
  std::string run;             ///< everything that determines the run: its run.json
  std::uint64_t position = 0;  ///< frames of the run that are complete
  std::vector<char> state;     ///< Denoiser::save()
};

/// Writes with write_file_atomically(). The file is little-endian: the magic "ELSTATE\n"; u32: the
/// format version, and 0; u64 each: position, size of `run`, size of `state`, and the XXH3-64 of
/// the rest of the file; then the bytes of `run` and of `state`.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws CheckpointError if the file is not a checkpoint, has another format version, or is
/// truncated or damaged (checksum); std::runtime_error if it cannot be read.
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Gives `load` the state of a checkpoint that was read from `path`. What it throws as
/// std::runtime_error, and bytes that it leaves over, become a CheckpointError naming the file.
void restore_state(const std::filesystem::path& path, const Checkpoint& checkpoint,
                   const std::function<void(StateReader&)>& load);

/// Throws CheckpointError naming the first of `files`, the output of `frame`, that is missing
/// though the checkpoint at `path` counts the frame as complete.
void check_complete(const std::filesystem::path& path, int frame,
                    std::span<const std::filesystem::path> files);

}  // namespace eigenlight
