// How far a run is, for people.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace eigenlight {

/// "48s", "3m05s", "2h10m"; negative or not finite: "?".
[[nodiscard]] std::string format_duration(double seconds);

/// Reports each frame as it is done: on a terminal one line that is redrawn in place, in a pipe one
/// plain line a frame. Time left is the mean time of the frames of this process times those to
/// come.
class Progress {
 public:
  enum class Style { kNone, kLines, kBar };

  /// `done` of `total` frames were complete before.
  Progress(std::ostream& out, Style style, std::size_t done, std::size_t total);
  /// Ends a line that was left open.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void frame_done(int frame);
  /// Ends the line of the bar, so that other text can follow.
  void finish();

 private:
  std::ostream& out_;
  Style style_;
  std::size_t before_, done_, total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool open_ = false;
};

}  // namespace eigenlight
