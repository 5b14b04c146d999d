#include "frame/float_traps.h"

#ifdef EIGENLIGHT_FLOAT_TRAPS

#include <execinfo.h>
#include <fenv.h>  // feenableexcept is of the C library alone
#include <unistd.h>

#include <csignal>
#include <cstring>

namespace eigenlight {
namespace {

constexpr int kFaults = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;

const char* name_of(int code) {
  switch (code) {
    case FPE_FLTDIV:
      return "floating-point division by zero\n";
    case FPE_FLTOVF:
      return "floating-point overflow\n";
    case FPE_FLTINV:
      return "invalid floating-point operation\n";
    default:
      return "arithmetic fault\n";
  }
}

// Only calls that are safe in a handler: the fault may be anywhere.
void report(int signal, siginfo_t* info, void*) {
  const char* name = name_of(info->si_code);
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, name, std::strlen(name));
  void* frames[32];
  ::backtrace_symbols_fd(frames, ::backtrace(frames, 32), STDERR_FILENO);
  ::raise(signal);  // SA_RESETHAND: now it ends the process
}

}  // namespace

void trap_float_faults() {
  // The first call of backtrace() loads a library, which a handler must not do.
  void* frame[1];
  ::backtrace(frame, 1);
  struct sigaction action = {};
  action.sa_sigaction = report;
  action.sa_flags = SA_SIGINFO | static_cast<int>(SA_RESETHAND);
  ::sigaction(SIGFPE, &action, nullptr);
  ::feclearexcept(kFaults);
  ::feenableexcept(kFaults);
}

FloatTrapsOff::FloatTrapsOff() : before_(::fegetexcept()) { ::fedisableexcept(kFaults); }

FloatTrapsOff::~FloatTrapsOff() {
  // What was raised meanwhile must not trap now.
  ::feclearexcept(kFaults);
  ::feenableexcept(before_);
}

}  // namespace eigenlight

#else

namespace eigenlight {
void trap_float_faults() {}
}  // namespace eigenlight

#endif
