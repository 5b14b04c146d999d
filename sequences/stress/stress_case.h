// The cases of `eigenlight stress`, each with a figure and its bound.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/stress/stress_run.h"

namespace eigenlight {

/// The result of a case.
struct StressFinding {
  double figure = 0.0;
  double bound = 0.0;
  std::string where;  ///< what the worst figure belongs to, or empty
  std::string note;   ///< a remark for people, or empty

  [[nodiscard]] bool pass() const { return std::islessequal(figure, bound); }  // NaN fails
};

struct StressCase {
  std::string_view name;  ///< theme.case
  std::string_view what;  ///< what the figure is
  bool is_long = false;   ///< takes minutes: only runs with --long
  StressFinding (*run)(StressLog&);
};

/// All cases, in the order in which they run.
[[nodiscard]] std::vector<StressCase> stress_cases();

/// The cases of each theme.
[[nodiscard]] std::vector<StressCase> value_cases();
[[nodiscard]] std::vector<StressCase> firefly_cases();
[[nodiscard]] std::vector<StressCase> algebra_cases();
[[nodiscard]] std::vector<StressCase> history_cases();
[[nodiscard]] std::vector<StressCase> size_cases();
[[nodiscard]] std::vector<StressCase> long_cases();
[[nodiscard]] std::vector<StressCase> statistics_cases();
[[nodiscard]] std::vector<StressCase> determinism_cases();
[[nodiscard]] std::vector<StressCase> basis_cases();

/// The worst figure in `log`, with its bound.
[[nodiscard]] inline StressFinding worst_of(const StressLog& log, double bound) {
  return {log.worst(), bound, log.worst_what(), {}};
}

}  // namespace eigenlight
