// `eigenlight stress`: everything that must not break the denoiser, tried.
#pragma once

#include <cstdint>
#include <string>

#include "sequences/cli/console.h"

namespace eigenlight {

struct StressSettings {
  bool json = false;
  bool takes_long = false;  ///< also the cases that take minutes
  std::string only;         ///< name of one case, or of a theme; empty: all
  std::uint32_t seed = 0;
  std::string directory = "out/stress";  ///< of what failing cases leave
};

/// Runs the cases (stress/stress_case.h) and prints a table, or with `json`
///   {"cases": [{"name", "frames", "figure", "bound", "pass", "seconds", "what", "where"}, ..]}
/// (a figure that is not finite is null). A failing case is run again to write, to a directory of
/// its name in `directory`, the pictures of the frame before and of the frame with the worst figure
/// (before.exr, frame.exr) and the history that it met (state.bin), and prints the command that
/// repeats it alone. Returns 0, or 1 if any case failed. Throws std::invalid_argument listing the
/// names if there is no such case.
[[nodiscard]] int stress_command(const StressSettings& settings, const Console& console);

}  // namespace eigenlight
