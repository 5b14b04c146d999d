// Who is compared, and which crop is shown: what plans of scenes and of recorded frames share.
#pragma once

#include "sequences/compare/compare_plan.h"

namespace eigenlight {

/// Letters, digits, `_`, `-` and `.` of `text`; all others become `-`. Never empty or hidden.
[[nodiscard]] std::string file_word(std::string text);

/// Throws std::invalid_argument naming an unknown method, or two contenders of one name.
[[nodiscard]] std::vector<Contender> make_contenders(const CompareSettings& settings);

/// Nothing if none is asked for. Throws std::invalid_argument if the text is no rectangle, or
/// reaches beyond `extent`.
[[nodiscard]] std::optional<CropPlan> make_crop(const CompareSettings& settings, Extent extent);

}  // namespace eigenlight
