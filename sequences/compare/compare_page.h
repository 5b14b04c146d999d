// The page of a comparison.
#pragma once

#include <string>
#include <vector>

#include "sequences/compare/compare_results.h"
#include "sequences/pages/page.h"

namespace eigenlight {

/// For each scene a section with relMSE against CPU time and its Pareto front, relMSE and temporal
/// error over the frames, a table of all figures, a table of what each part of a method is worth
/// (if a contender lacks a part), and the gallery of the scene. A last section holds machine and
/// settings. Throws std::invalid_argument unless there is one gallery for each scene.
[[nodiscard]] Page compare_page(const ComparePlan& plan, const std::vector<CaseResults>& results,
                                std::vector<PageGallery> galleries);

}  // namespace eigenlight
