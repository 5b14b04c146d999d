#include "sequences/files/file_pattern.h"

#include <fmt/format.h>

#include <charconv>

#include "frame/check.h"

namespace eigenlight {
namespace {

constexpr int kSingleHash = 4;  // as in V-Ray, Nuke and oiiotool
constexpr int kMaxDigits = 16;

struct Place {
  std::size_t begin = 0, size = 0;
  int digits = 1;
};

// `%d` or `%0Nd` at `begin`.
std::optional<Place> printf_place(std::string_view text, std::size_t begin) {
  std::size_t end = begin + 1;
  int digits = 1;
  if (end < text.size() && text[end] == '0') {
    const auto [stop, error] =
        std::from_chars(text.data() + end, text.data() + text.size(), digits);
    if (error != std::errc{}) return std::nullopt;
    end = static_cast<std::size_t>(stop - text.data());
  }
  if (end >= text.size() || text[end] != 'd' || digits > kMaxDigits) return std::nullopt;
  return Place{begin, end + 1 - begin, digits};
}

std::optional<Place> find_place(std::string_view text, std::size_t from) {
  for (std::size_t i = text.find_first_of("#@%", from); i != std::string_view::npos;
       i = text.find_first_of("#@%", i + 1)) {
    if (text[i] == '%') {
      if (const auto place = printf_place(text, i)) return place;
      continue;
    }
    std::size_t size = text.find_first_not_of(text[i], i);
    size = (size == std::string_view::npos ? text.size() : size) - i;
    const int digits = text[i] == '#' && size == 1 ? kSingleHash : static_cast<int>(size);
    return Place{i, size, digits};
  }
  return std::nullopt;
}

}  // namespace

FilePattern::FilePattern(std::string_view text) {
  const auto place = find_place(text, 0);
  EL_CHECK(place, "pattern '{}': expected a place for the frame number: ####, @@@@ or %04d", text);
  const std::size_t end = place->begin + place->size;
  EL_CHECK(!find_place(text, end), "pattern '{}': more than one place for the frame number", text);
  before_ = text.substr(0, place->begin);
  after_ = text.substr(end);
  digits_ = place->digits;
}

std::string FilePattern::name(int frame) const {
  return fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

std::optional<int> FilePattern::frame(std::string_view text) const {
  if (text.size() < before_.size() + after_.size() || !text.starts_with(before_) ||
      !text.ends_with(after_)) {
    return std::nullopt;
  }
  const std::string_view number =
      text.substr(before_.size(), text.size() - before_.size() - after_.size());
  int frame = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), frame);
  if (error != std::errc{} || end != number.data() + number.size()) return std::nullopt;
  // The same number with another width is another file.
  if (name(frame) != text) return std::nullopt;
  return frame;
}

}  // namespace eigenlight
