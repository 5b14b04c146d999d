#include "sequences/cli/progress.h"

#include <fmt/format.h>

#include <cmath>

namespace eigenlight {
namespace {

constexpr std::size_t kBarWidth = 24;  // taste: the whole line stays under 80 columns

}  // namespace

std::string format_duration(double seconds) {
  // Beyond a year a number says nothing, and would not fit the types below.
  if (!std::isfinite(seconds) || seconds < 0.0 || seconds > 3.2e7) return "?";
  const long total = std::lround(seconds);
  if (total < 60) return fmt::format("{}s", total);
  if (total < 3600) return fmt::format("{}m{:02}s", total / 60, total % 60);
  return fmt::format("{}h{:02}m", total / 3600, total % 3600 / 60);
}

Progress::Progress(std::ostream& out, Style style, std::size_t done, std::size_t total)
    : out_(out), style_(style), before_(done), done_(done), total_(total) {}

Progress::~Progress() { finish(); }

void Progress::finish() {
  if (open_) out_ << '\n' << std::flush;
  open_ = false;
}

void Progress::frame_done(int frame) {
  ++done_;
  if (style_ == Style::kNone) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const double rate = static_cast<double>(done_ - before_) / elapsed.count();
  const double left = static_cast<double>(total_ - done_) / rate;
  const std::string text = fmt::format("frame {}  {}/{}  {:.2f} frames/s  {} left", frame, done_,
                                       total_, rate, format_duration(left));
  if (style_ == Style::kLines) {
    out_ << text << '\n' << std::flush;
    return;
  }
  const std::size_t filled = kBarWidth * done_ / total_;
  // \x1b[K clears what a longer line left behind.
  out_ << fmt::format("\r[{:-<{}}] {}\x1b[K", std::string(filled, '#'), kBarWidth, text)
       << std::flush;
  open_ = true;
}

}  // namespace eigenlight
