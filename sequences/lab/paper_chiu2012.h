// The rerun of Chiu 2012 in parts; each adds its claims and sections to the report.
#pragma once

#include "sequences/lab/paper.h"

namespace eigenlight {

void chiu_times(const PaperRun& run, PaperReport& report);   ///< Table 1, Fig. 3
void chiu_errors(const PaperRun& run, PaperReport& report);  ///< Fig. 5

}  // namespace eigenlight
