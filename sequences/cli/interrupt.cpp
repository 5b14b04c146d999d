#include "sequences/cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

#include "sequences/cli/command.h"
#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

std::atomic<bool> was_interrupted{false};
std::atomic<bool> says_so{false};
struct sigaction previous_interrupt, previous_terminate;

// Only async-signal-safe calls in here.
void on_signal(int) {
  const int saved_errno = errno;
  if (was_interrupted.exchange(true)) {
    remove_unfinished_file();
    ::_exit(kInterrupted);
  }
  if (says_so) {
    constexpr char kText[] = "\neigenlight: finishing the current step; again to stop at once\n";
    // The terminal may be gone; there is nothing to do about that.
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText, sizeof(kText) - 1);
  }
  errno = saved_errno;
}

}  // namespace

InterruptGuard::InterruptGuard(Notice notice) {
  was_interrupted = false;
  says_so = notice == Notice::kStderr;
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, &previous_interrupt);
  ::sigaction(SIGTERM, &action, &previous_terminate);
}

InterruptGuard::~InterruptGuard() {
  ::sigaction(SIGINT, &previous_interrupt, nullptr);
  ::sigaction(SIGTERM, &previous_terminate, nullptr);
}

bool InterruptGuard::interrupted() const { return was_interrupted; }

}  // namespace eigenlight
