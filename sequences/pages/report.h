// The page that people look at after a run.
#pragma once

#include <filesystem>

namespace eigenlight {

/// Writes `dir`/index.html from what a run left in `dir`: run.json, frames.jsonl and
/// frame.####.exr. One page without any other file or network: a player of the frames, noisy
/// beside denoised (sRGB, with the exposure of run.json), and plots of stage times, new pixels and
/// rank over the frames.
///
/// Long or large runs are thinned to keep the page small: pictures get smaller and, past 240
/// frames, only every n-th is shown; plots and table always hold all frames. A frame that
/// frames.jsonl names but whose EXR is missing is left out of the player. The page replaces an
/// older one in one step, so that a reader never sees half of it.
///
/// Throws std::runtime_error naming the file, and the line of frames.jsonl, that is missing or
/// cannot be read. Cost: reads every picture that is shown once.
void write_report(const std::filesystem::path& dir);

}  // namespace eigenlight
