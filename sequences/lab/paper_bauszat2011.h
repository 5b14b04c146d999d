// The rerun of Bauszat 2011 in parts; each adds its claims and sections to the report.
#pragma once

#include "sequences/lab/paper.h"

namespace eigenlight {

void bauszat_rendering_times(const PaperRun& run, PaperReport& report);  ///< Table 1
void bauszat_filter_times(const PaperRun& run, PaperReport& report);     ///< Table 2
void bauszat_errors(const PaperRun& run, PaperReport& report);           ///< Fig. 5 and 8

}  // namespace eigenlight
