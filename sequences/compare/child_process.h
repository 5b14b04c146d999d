// Other people's programs.
#pragma once

#include <filesystem>
#include <string>

namespace eigenlight {

struct ChildResult {
  int status = 0;       ///< exit status, or 128 + signal as a shell has it
  double cpu_ms = 0.0;  ///< of it and of all children that it waited for
  /// Largest resident set of any of its processes, 10^6 bytes, looked at every 5 ms; 0 where the
  /// program was over before that.
  double peak_mb = 0.0;
  std::string out, err;  ///< what it printed
};

/// Runs `command` with /bin/sh, its input empty, and waits for its end. What it prints goes through
/// two files in `scratch`, which are removed. Throws std::runtime_error if no process can be
/// started.
[[nodiscard]] ChildResult run_shell(const std::string& command,
                                    const std::filesystem::path& scratch);

}  // namespace eigenlight
