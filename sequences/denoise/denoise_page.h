// The page of a run of `denoise`.
#pragma once

#include <filesystem>

#include "sequences/denoise/denoise_run.h"
#include "sequences/pages/page.h"

namespace eigenlight {

/// The folder of the page, with its log: `page` beside the first output.
[[nodiscard]] std::filesystem::path denoise_page_folder(const DenoisePlan& plan);

/// A player that shows noisy beside denoised frames, the beauty and each layer of light; warnings;
/// the table of layers; what was found out about them; times of stages; and plots of times and of
/// new pixels over the frames.
///
/// Reads the inputs and outputs of the frames that it shows, and frames.jsonl (DenoiseLog), which
/// tells of all frames, also of those before a run was resumed. Throws what reading them throws.
[[nodiscard]] Page denoise_page(const DenoisePlan& plan, const DenoiseTotals& totals);

/// Writes denoise_page() to index.html in denoise_page_folder(), whole.
void write_denoise_page(const DenoisePlan& plan, const DenoiseTotals& totals);

}  // namespace eigenlight
