// The page of a run: pictures and measurements of all its frames.
#pragma once

#include <filesystem>

#include "sequences/pages/page.h"

namespace eigenlight {

/// The page of the run in `dir`, from its run.json, frames.jsonl and frame.####.exr: a player that
/// shows noisy beside denoised frames (run_pictures.h), tables of the run, of mean times and of
/// skipped work, and plots of stage times, new pixels and rank over the frames.
///
/// Plots and tables cover all frames of frames.jsonl, also those without an EXR file. Throws
/// std::runtime_error naming the file, and the line of frames.jsonl, that is missing or cannot be
/// read. Reads every picture that it shows once.
[[nodiscard]] Page run_page(const std::filesystem::path& dir);

/// Writes run_page() to `dir`/index.html. The file is replaced in one step, so that it is always
/// whole.
void write_run_page(const std::filesystem::path& dir);

}  // namespace eigenlight
