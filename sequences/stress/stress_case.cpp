#include "sequences/stress/stress_case.h"

namespace eigenlight {

std::vector<StressCase> stress_cases() {
  std::vector<StressCase> all;
  for (const auto& theme :
       {value_cases(), firefly_cases(), algebra_cases(), history_cases(), size_cases(),
        statistics_cases(), determinism_cases(), long_cases(), basis_cases()}) {
    all.insert(all.end(), theme.begin(), theme.end());
  }
  return all;
}

}  // namespace eigenlight
