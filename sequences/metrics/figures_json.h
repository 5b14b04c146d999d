// Figures of metrics.h as JSON, there and back.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "sequences/metrics/metrics.h"

namespace eigenlight {

/// {name: value, ..., "energy": Figures::energy(), "pixels": n}; names are kMetricNames. A figure
/// that was not measured is absent, and so is an infinite PSNR, which JSON cannot hold.
[[nodiscard]] nlohmann::ordered_json to_json(const Figures& figures);
/// {"frame": n, figures of all pixels, "young": {..}, "old": {..}}; sets without pixels are absent.
[[nodiscard]] nlohmann::ordered_json to_json(const FrameFigures& frame);
/// {"mean": {..}, "young": {..}, "old": {..}}; sets without pixels are absent.
[[nodiscard]] nlohmann::ordered_json to_json(const SetFigures& sets);

/// What to_json(FrameFigures) wrote, but for infinite values. Throws nlohmann::json::exception on
/// anything else.
[[nodiscard]] FrameFigures frame_figures_from_json(const nlohmann::ordered_json& json);

}  // namespace eigenlight
