// Ctrl-C: once to stop after the frame in hand, twice to stop at once.
#pragma once

namespace eigenlight {

/// Exit status of a run that was interrupted, by SIGINT or SIGTERM alike (128 + SIGINT).
inline constexpr int kInterruptedStatus = 130;

/// While it lives, the first SIGINT or SIGTERM only sets a flag; a second one removes the
/// unfinished file, if any, and ends the process with kInterruptedStatus. The handlers before it
/// come back afterwards. One at a time.
class InterruptGuard {
 public:
  enum class Notice { kSilent, kStderr };  ///< whether the first signal says what it does

  explicit InterruptGuard(Notice notice);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] bool interrupted() const;
};

}  // namespace eigenlight
