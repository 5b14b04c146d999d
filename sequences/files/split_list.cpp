#include "sequences/files/split_list.h"

#include <algorithm>
#include <charconv>

#include "frame/check.h"

namespace eigenlight {

std::vector<std::string> split_list(std::string_view option, std::string_view text) {
  std::vector<std::string> entries;
  if (text.empty()) return entries;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::string entry(rest.substr(0, comma));
    EL_CHECK(!entry.empty(), "{} '{}': expected names with one comma between them", option, text);
    EL_CHECK(std::find(entries.begin(), entries.end(), entry) == entries.end(),
             "{} '{}': '{}' is named twice", option, text, entry);
    entries.push_back(entry);
    if (comma == std::string_view::npos) return entries;
    rest.remove_prefix(comma + 1);
  }
}

std::vector<int> split_numbers(std::string_view option, std::string_view text, NumberRange range) {
  std::vector<int> numbers;
  for (const std::string& entry : split_list(option, text)) {
    int number = 0;
    const char* end = entry.data() + entry.size();
    const auto [stop, error] = std::from_chars(entry.data(), end, number);
    EL_CHECK(error == std::errc{} && stop == end && number >= range.low && number <= range.high,
             "{} '{}': '{}' is not a number from {} to {}", option, text, entry, range.low,
             range.high);
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace eigenlight
