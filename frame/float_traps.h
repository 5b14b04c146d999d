// Floating-point traps: a build with EIGENLIGHT_FLOAT_TRAPS (preset `debug`) stops at the operation
// that made the first NaN or Inf, instead of showing it three stages later. Other builds: nothing.
#pragma once

namespace eigenlight {

/// From here on an invalid operation (0 / 0, Inf - Inf, the root of a negative number, an ordered
/// comparison of NaN, a float beyond the integers it is converted to), a division by zero and an
/// overflow end the process with SIGFPE, after one line that names the fault and a backtrace. Holds
/// for the calling thread and for those that it starts later.
void trap_float_faults();

/// No traps on this thread, and on those it starts, while this lives: around libraries that
/// calculate with Inf or NaN and mean it, and where values that are not finite are the subject.
class FloatTrapsOff {
 public:
#ifdef EIGENLIGHT_FLOAT_TRAPS
  FloatTrapsOff();
  ~FloatTrapsOff();
#else
  FloatTrapsOff() {}
#endif
  FloatTrapsOff(const FloatTrapsOff&) = delete;
  FloatTrapsOff& operator=(const FloatTrapsOff&) = delete;

#ifdef EIGENLIGHT_FLOAT_TRAPS
 private:
  int before_;  // the traps that were on
#endif
};

}  // namespace eigenlight
