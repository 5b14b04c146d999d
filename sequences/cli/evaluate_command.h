// `eigenlight evaluate`: a sequence against its reference.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sequences/metrics/evaluate.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// Adds the sub-command, which measures when it is parsed, and prints a table or JSON to `out`,
/// which must outlive `app`. Errors leave it as std::runtime_error or std::invalid_argument.
void add_evaluate_command(CLI::App& app, std::ostream& out);

/// `frames` (how many were measured), `mean`, `young`, `old` (means over frames; young and old only
/// if there are such pixels), `per_frame`, `skipped`, `bad_pixels`, and what the pixel sets come
/// from. Names are kMetricNames. Under a light step there are also `step`, in `mean` `lag_frames`
/// and `lag_error` (Lag; relMSE x frames), and `step_reached` in `per_frame`. A figure that was not
/// measured is absent, and so is an infinite PSNR, which JSON cannot hold.
[[nodiscard]] nlohmann::ordered_json to_json(const Evaluation& evaluation);

/// The same for people: a column per pixel set, a row per figure.
[[nodiscard]] std::string to_table(const Evaluation& evaluation);

}  // namespace eigenlight
