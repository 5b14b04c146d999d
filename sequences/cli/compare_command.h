// `eigenlight compare`: error and time of many methods on the same noisy frames.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

/// Exit status 0, or kInterrupted after Ctrl-C. An interrupted run keeps what is complete (frames
/// of references, methods at a sample count), and the same command goes on from there. Writes into
/// the directory of -o:
///   index.html    the page (compare_page.h)
///   results.json  all results (compare_results.h)
///   results.csv   a line for each scene, method and sample count
///   crops-SCENE.jpg  one crop of each method (compare_crops.h), with --crop
///   frames/       the measured frames, SCENE/METHOD/frame.####.exr, at the sample count shown
///   cells/        results so far, each under the hash of all that decides it, the program included
/// EXR patterns in place of scenes: compare_recorded.h. With --paper it reruns a paper instead
/// (compare_paper.h). Throws std::invalid_argument for a bad option, std::runtime_error for all
/// other errors.
[[nodiscard]] Command add_compare_command(CLI::App& app);

}  // namespace eigenlight
