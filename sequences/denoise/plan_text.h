// A plan as text for people and as JSON for programs.
#pragma once

#include <string>

#include "sequences/denoise/denoise_run.h"

namespace eigenlight {

/// The table of layers, then what was found out about sums, cameras, guides and motion, then
/// warnings.
[[nodiscard]] std::string to_text(const DenoisePlan& plan);
/// The same as one object.
[[nodiscard]] std::string to_json(const DenoisePlan& plan);

[[nodiscard]] std::string to_text(const DenoiseTotals& totals);
[[nodiscard]] std::string to_json(const DenoiseTotals& totals);

}  // namespace eigenlight
