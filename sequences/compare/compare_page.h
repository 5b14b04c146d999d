// The page of a comparison.
#pragma once

#include <string>
#include <vector>

#include "sequences/compare/compare_results.h"
#include "sequences/pages/page_builder.h"

namespace eigenlight {

/// A section for each scene: relMSE against CPU time with the Pareto front, relMSE and temporal
/// error over the frames, the table, what each part of a method is worth (where contenders lack
/// one), and its gallery, of which there must be one for each scene.
[[nodiscard]] Page compare_page(const ComparePlan& plan, const std::vector<CaseResults>& results,
                                std::vector<PageGallery> galleries);

}  // namespace eigenlight
