// What a run keeps in memory, and how far it can look ahead with it.
#pragma once

#include <cstdint>
#include <string>

#include "sequences/exr/exr_file.h"
#include "sequences/layers/layer_plan.h"

namespace eigenlight {

/// Bytes for each pixel of the canvas, all views together: of the frames in flight, the denoisers
/// and the checkpoint, and of each later frame that waits. Counted from the planes that are kept;
/// the parts of the denoiser were measured (docs/experiments/2026-12-looking-ahead.md).
struct MemoryPlan {
  double fixed = 0.0, per_frame = 0.0;

  [[nodiscard]] double bytes(const ExrWindow& canvas, int lookahead) const {
    return (fixed + per_frame * lookahead) * static_cast<double>(canvas.width) *
           static_cast<double>(canvas.height);
  }
};
[[nodiscard]] MemoryPlan plan_memory(const LayerPlan& layers);

/// `8G`, `500M`, `1.5T`: a number with K, M, G or T (powers of 1024), or bytes. Throws
/// std::invalid_argument if it is anything else or not positive.
[[nodiscard]] double parse_memory(const std::string& text);

/// The most later frames, up to `wanted`, that fit `most` bytes. Throws std::invalid_argument that
/// says what would fit if none do.
[[nodiscard]] int fit_lookahead(const MemoryPlan& memory, const ExrWindow& canvas, int wanted,
                                double most);

}  // namespace eigenlight
