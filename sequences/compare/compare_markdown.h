// A comparison as tables in Markdown.
#pragma once

#include <string>
#include <vector>

#include "sequences/compare/compare_results.h"

namespace eigenlight {

/// What was measured, in words, and these tables, of which each stands only where it has something
/// to tell:
///   all cells      a row for each scene, sample count and contender: relMSE and temporal error,
///                  also as multiples of plan.baseline(); energy; MSE; time
///   energy         contenders by scenes, at plan.shown_spp() (several scenes)
///   equal time     relMSE of all contenders by scenes at one CPU time (several sample counts)
///   parts          contenders without a part beside the whole (plan with ablations)
/// For ways of antialiasing the time is that of antialiasing beside the rest of the frame.
[[nodiscard]] std::string to_markdown(const ComparePlan& plan,
                                      const std::vector<CaseResults>& results);

}  // namespace eigenlight
