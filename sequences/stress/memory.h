// Memory of this process, as Linux counts it.
#pragma once

namespace eigenlight {

[[nodiscard]] double resident_bytes();  ///< now
[[nodiscard]] double peak_bytes();      ///< the most so far

}  // namespace eigenlight
