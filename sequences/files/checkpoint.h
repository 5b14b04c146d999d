// The state of a run between two frames, on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace eigenlight {

/// A checkpoint that must not be used. The message names the file and what is wrong with it.
class CheckpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Checkpoint {
  std::string run;             ///< everything that determines the run (describe_run(), as JSON)
  std::uint64_t position = 0;  ///< frames of the run that are complete
  std::vector<char> state;     ///< Denoiser::save()
};

/// Writes in one step (write_file_atomically). The file, little-endian: the magic "ELSTATE\n", a
/// u32 format version, and u64 each of position, size of `run`, size of `state` and the XXH3-64 of
/// all the rest of the file; then the bytes of `run` and of `state`.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws CheckpointError on a file that is no checkpoint, of another format version, truncated or
/// damaged (checksum); std::runtime_error if it cannot be read at all.
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace eigenlight
