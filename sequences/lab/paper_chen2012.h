// The rerun of Chen 2012 in parts; each adds its claims and one section to the report.
#pragma once

#include "sequences/lab/paper.h"

namespace eigenlight {

void chen_stage_times(const PaperRun& run, PaperReport& report);      ///< Table 1
void chen_rendering_times(const PaperRun& run, PaperReport& report);  ///< Table 2
void chen_disocclusion(const PaperRun& run, PaperReport& report);     ///< Fig. 5
void chen_flicker(const PaperRun& run, PaperReport& report);          ///< Fig. 7
void chen_error(const PaperRun& run, PaperReport& report);            ///< Fig. 10
void chen_bases(const PaperRun& run, PaperReport& report);            ///< Fig. 15

}  // namespace eigenlight
