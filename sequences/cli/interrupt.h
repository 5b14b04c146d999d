// Ctrl-C: once to stop after the current step, twice to stop at once.
#pragma once

namespace eigenlight {

/// While it lives, the first SIGINT or SIGTERM only sets a flag; a second one removes the
/// unfinished file, if any, and ends the process with kInterrupted (command.h). The destructor
/// restores the handlers that were there before. One at a time.
class InterruptGuard {
 public:
  enum class Notice { kSilent, kStderr };  ///< whether the first signal prints a line

  explicit InterruptGuard(Notice notice);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] bool interrupted() const;
};

}  // namespace eigenlight
