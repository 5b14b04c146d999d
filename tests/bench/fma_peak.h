// How fast this machine multiplies and adds.
#pragma once

namespace eigenlight {

/// Billions of floating-point operations per second of CPU time of one thread, a multiply-add being
/// two, on the Highway target in use: a measurement of about a millisecond. Operands stay in
/// registers.
[[nodiscard]] double fma_gflops();

}  // namespace eigenlight
