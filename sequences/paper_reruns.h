// The papers whose claims are measured again: each by its own file, or files of its name.
#pragma once

#include "sequences/paper.h"

namespace eigenlight {

/// Chen, Lei and Chang 2012: Tables 1 and 2, Fig. 7, 10 and 15.
[[nodiscard]] PaperReport rerun_chen2012(const PaperRun& run);

}  // namespace eigenlight
