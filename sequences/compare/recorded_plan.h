// Plans of comparisons on recorded frames.
#pragma once

#include "sequences/compare/compare_plan.h"

namespace eigenlight {

/// Whether the inputs are EXR files, in place of scenes.
[[nodiscard]] bool is_recorded(const CompareSettings& settings);

/// Frames that are measured: those of settings.frames, else all that inputs and references have.
/// Frames that are denoised: all that exist from settings.warmup before these on. Methods if none
/// are named: `eigenlight`, which is what `eigenlight denoise` does, and `noisy`. One sample count,
/// 0, stands for that of the files.
///
/// Throws std::invalid_argument naming the option and what was expected, also for a method that
/// needs more than recorded frames hold; BadFile naming a file that is missing or lacks the layer.
[[nodiscard]] ComparePlan make_recorded_plan(const CompareSettings& settings);

/// R, G, B of shot.layer in the inputs of a frame. `files`: the inputs, or files written from them.
/// Throws BadFile naming the first file if none has it.
[[nodiscard]] Planes<3> read_shot_layer(const std::vector<std::filesystem::path>& files,
                                        const std::string& layer);

}  // namespace eigenlight
