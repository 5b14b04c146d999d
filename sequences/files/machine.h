// The machine and the day, for the heads of what is measured.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace eigenlight {

struct Machine {
  std::string processor;        ///< model name, or `unknown`
  std::string instruction_set;  ///< the widest of AVX-512, AVX2 and SSE4.2 that it has
  std::string compiler;         ///< that built this program
  unsigned cores = 0;           ///< hardware threads
};
[[nodiscard]] Machine this_machine();

/// Bytes of memory that the machine has.
[[nodiscard]] double machine_memory();

/// The members by name.
[[nodiscard]] nlohmann::ordered_json to_json(const Machine& machine);
/// `Intel Xeon, 2 cores, AVX-512`.
[[nodiscard]] std::string to_text(const Machine& machine);

/// The day in UTC, `2026-11-30`.
[[nodiscard]] std::string today();

}  // namespace eigenlight
