// `eigenlight compare --paper`: what a paper prints, beside what it gives here.
#pragma once

#include "sequences/cli/console.h"
#include "sequences/compare/compare_plan.h"

namespace eigenlight {

/// Reruns settings.paper at settings.size and over settings.frames, or its own size and frames
/// where these are empty, on settings.threads. Writes results.json (paper_json()) and index.html
/// into settings.directory, and prints the claims as a table in Markdown. Returns 0, or
/// kInterruptedStatus after Ctrl-C, when nothing is written. Throws std::invalid_argument for a bad
/// option, std::runtime_error if a file cannot be written.
[[nodiscard]] int paper_command(const CompareSettings& settings, const Console& console);

}  // namespace eigenlight
