// The cases of `eigenlight stress`: what each checks, and the bound that it must stay within.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/stress/lab.h"

namespace eigenlight {

/// What a case found.
struct StressFinding {
  double figure = 0.0;
  double bound = 0.0;
  std::string where;  ///< what the worst figure belongs to; may be empty
  std::string note;   ///< for people, beside the figure; may be empty

  [[nodiscard]] bool pass() const { return std::islessequal(figure, bound); }  // NaN fails
};

struct StressCase {
  std::string_view name;  ///< theme.case
  std::string_view what;  ///< what the figure is, and where its bound is from
  bool is_long = false;   ///< takes more than seconds: with --long only
  StressFinding (*run)(Lab&);
};

/// All cases, in the order they are run.
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

/// The worst figure that was noted in `lab`, against `bound`.
[[nodiscard]] inline StressFinding worst_of(const Lab& lab, double bound) {
  return {lab.worst(), bound, lab.worst_what(), {}};
}

}  // namespace eigenlight
