#include "sequences/files/frame_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>

#include "frame/check.h"

namespace eigenlight {
namespace {

// Longer than any film, and small enough that no arithmetic overflows.
constexpr int kMaxFrame = 10'000'000;
constexpr std::size_t kMaxFrames = 1'000'000;

struct Part {
  int first = 0, last = 0, step = 1;
};

// Takes an integer off the front of `text`.
std::optional<int> take_number(std::string_view& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || value > kMaxFrame || value < -kMaxFrame) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

std::optional<Part> parse_part(std::string_view text) {
  const auto first = take_number(text);
  if (!first) return std::nullopt;
  Part part{*first, *first, 1};
  if (text.empty()) return part;
  if (text.front() != '-') return std::nullopt;
  text.remove_prefix(1);
  const auto last = take_number(text);
  if (!last) return std::nullopt;
  part.last = *last;
  if (text.empty()) return part;
  if (text.front() != 'x') return std::nullopt;
  text.remove_prefix(1);
  const auto step = take_number(text);
  if (!step || *step < 1 || !text.empty()) return std::nullopt;
  part.step = *step;
  return part;
}

void append(const Part& part, std::vector<int>& frames) {
  const int distance = std::abs(part.last - part.first);
  const int count = distance / part.step + 1;
  EL_CHECK(frames.size() + static_cast<std::size_t>(count) <= kMaxFrames,
           "frames {}-{}: more than {} frames", part.first, part.last, kMaxFrames);
  const int step = part.last < part.first ? -part.step : part.step;
  for (int i = 0; i < count; ++i) frames.push_back(part.first + i * step);
}

void check_unique(std::vector<int> frames) {
  std::sort(frames.begin(), frames.end());
  const auto twice = std::adjacent_find(frames.begin(), frames.end());
  EL_CHECK(twice == frames.end(), "frames: frame {} is named twice", *twice);
}

}  // namespace

std::vector<int> parse_frame_range(std::string_view text) {
  std::vector<int> frames;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view word = rest.substr(0, comma);
    const auto part = parse_part(word);
    EL_CHECK(
        part,
        "frames '{}': expected 7, 1-10, 5-1 or 1-100x5, or several of them with commas; numbers "
        "up to {}",
        word, kMaxFrame);
    append(*part, frames);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  check_unique(frames);
  return frames;
}

std::string format_frame_range(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i + 1;
    const int step = end < frames.size() ? frames[end] - frames[i] : 0;
    while (end < frames.size() && frames[end] - frames[end - 1] == step) ++end;
    if (!text.empty()) text += ',';
    // Two frames with a gap read better as two numbers.
    if (end - i == 1 || (end - i == 2 && std::abs(step) != 1)) {
      text += fmt::format("{}", frames[i]);
      i += 1;
      continue;
    }
    text += fmt::format("{}-{}", frames[i], frames[end - 1]);
    if (std::abs(step) != 1) text += fmt::format("x{}", std::abs(step));
    i = end;
  }
  return text;
}

}  // namespace eigenlight
