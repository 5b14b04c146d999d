// The rerun of Xu 2024 in parts; each adds its claims and sections to the report.
#pragma once

#include "sequences/lab/paper.h"

namespace eigenlight {

/// Fig. 8-11 and section 5.1: PSNR and SSIM against brute force in the four uses, with trained and
/// untrained weights and in two passes of one dimension.
void xu_quality(const PaperRun& run, PaperReport& report);

/// How these figures depend on the input: raw or compressed samples, more samples, accumulation.
void xu_inputs(const PaperRun& run, PaperReport& report);

/// Fig. 4 and 6: the effect of the range function on the way down and on the way up.
void xu_parts(const PaperRun& run, PaperReport& report);

/// Fig. 12 and Table 2: time by radius, and times of other filters.
void xu_times(const PaperRun& run, PaperReport& report);

}  // namespace eigenlight
