// Memory of this process, as Linux counts it.
#pragma once

namespace eigenlight {

[[nodiscard]] double resident_bytes();  ///< now
[[nodiscard]] double peak_bytes();      ///< the largest so far

}  // namespace eigenlight
