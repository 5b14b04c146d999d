// One method at one sample count on one scene: what was measured, and its place on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sequences/metrics/metrics.h"

namespace eigenlight {

/// What antialiasing costs a frame, means over the measured frames.
struct AntialiasCost {
  double ms = 0.0;            ///< CPU time of antialiasing the denoised frame
  double reference_ms = 0.0;  ///< the same of kAntialiasReference
  double unmatched = 0.0;     ///< path-traced eye rays over four times the surface pixels
};

struct Cell {
  std::string contender;             ///< its label
  int spp = 0;                       ///< 0: of recorded frames
  std::vector<FrameFigures> frames;  ///< the measured ones
  /// CPU milliseconds a frame, means over the measured frames: rendering, with the extra samples
  /// that the method asked for, and the method itself.
  double render_ms = 0.0, denoise_ms = 0.0;
  double files_ms = 0.0;  ///< the same for reading, converting and writing recorded frames
  std::optional<AntialiasCost> antialias;  ///< of ways of antialiasing
  double extra_spp = 0.0;                  ///< extra samples per surface pixel, mean
  double memory_mb = 0.0;                  ///< 10^6 bytes; of what: kMemoryNote
  std::int64_t bad_pixels = 0;             ///< of the method, with NaN or Inf: excluded

  [[nodiscard]] double total_ms() const {
    return render_ms + files_ms + denoise_ms + (antialias ? antialias->ms : 0.0);
  }
  [[nodiscard]] SetFigures mean() const { return mean_figures(frames); }
};

inline constexpr const char* kMemoryNote =
    "methods of ours: largest growth of the heap by the method's own buffers, its copy of the "
    "frame "
    "included; programs: largest resident set";

/// `contender`, `spp`, `cpu_ms` {render, denoise, total} (of recorded frames `files` for `render`),
/// `antialias` {cpu_ms, reference_cpu_ms, unmatched} where there is one, `extra_spp`, `memory_mb`,
/// `bad_pixels`, the means of to_json(SetFigures), and `per_frame`.
[[nodiscard]] nlohmann::ordered_json to_json(const Cell& cell);
/// Throws nlohmann::json::exception on anything that to_json(Cell) did not write.
[[nodiscard]] Cell cell_from_json(const nlohmann::ordered_json& json);

/// Cells of this and former runs in a directory, each under the hash of all that decides it.
class CellStore {
 public:
  /// `shared` is what decides all cells. Makes the directory. Throws std::runtime_error if it
  /// cannot be made.
  CellStore(std::filesystem::path directory, const nlohmann::ordered_json& shared);

  /// Nothing if there is no such cell, or its file cannot be understood.
  [[nodiscard]] std::optional<Cell> load(const nlohmann::ordered_json& identity) const;
  void save(const nlohmann::ordered_json& identity, const Cell& cell) const;

 private:
  [[nodiscard]] std::filesystem::path file(const nlohmann::ordered_json& identity) const;

  std::filesystem::path directory_;
  std::string shared_;
};

}  // namespace eigenlight
