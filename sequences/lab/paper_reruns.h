// The papers whose claims are measured again. Each has files of its name and a line in papers()
// (paper.cpp).
#pragma once

#include "sequences/lab/paper.h"

namespace eigenlight {

[[nodiscard]] Paper chen2012();     ///< Tables 1 and 2, Fig. 5, 7, 10 and 15
[[nodiscard]] Paper bauszat2011();  ///< Tables 1 and 2, Fig. 5 and 8
[[nodiscard]] Paper chiu2012();     ///< Table 1, Fig. 3 and 5
[[nodiscard]] Paper xu2024();       ///< Fig. 4, 6 and 8-12, Table 2

}  // namespace eigenlight
