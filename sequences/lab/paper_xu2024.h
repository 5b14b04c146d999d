// Parts of the rerun of Xu 2024; each appends its claims and its section to the report.
#pragma once

#include "sequences/lab/paper.h"

namespace eigenlight {

/// Fig. 8-11 and section 5.1: PSNR and SSIM against brute force in the four uses, with trained and
/// untrained weights and in two passes of one dimension.
void xu_quality(const PaperRun& run, PaperReport& report);

/// What the input does to these figures: raw samples, compressed ones, more of them, accumulated.
void xu_inputs(const PaperRun& run, PaperReport& report);

/// Fig. 4 and 6: what the range function does on the way down and on the way up.
void xu_parts(const PaperRun& run, PaperReport& report);

/// Fig. 12 and Table 2: time against the radius and against other filters.
void xu_times(const PaperRun& run, PaperReport& report);

}  // namespace eigenlight
