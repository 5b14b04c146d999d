// `eigenlight compare --paper`: what a paper claims, beside what is measured here.
#pragma once

#include "sequences/cli/command.h"
#include "sequences/cli/job.h"
#include "sequences/compare/compare_plan.h"

namespace eigenlight {

/// Reruns settings.paper at settings.size and over settings.frames; an empty size is the paper's
/// own, empty frames are 0-23. Writes results.json (paper_json()) and index.html into
/// settings.directory, and prints the claims as a table in Markdown. Returns kSuccess. Throws
/// Interrupted after Ctrl-C, with nothing written, std::invalid_argument for a bad option,
/// std::runtime_error if a file cannot be written.
[[nodiscard]] int compare_paper(const CompareSettings& settings, const Job& job);

}  // namespace eigenlight
