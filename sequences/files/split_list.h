// Comma-separated lists in options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace eigenlight {

/// Splits `a,b` into {a, b}; an empty text has no entries. Throws std::invalid_argument naming
/// `option` if an entry is empty or repeated.
[[nodiscard]] std::vector<std::string> split_list(std::string_view option, std::string_view text);

/// A list of whole numbers in [low, high].
struct NumberRange {
  int low, high;
};
[[nodiscard]] std::vector<int> split_numbers(std::string_view option, std::string_view text,
                                             NumberRange range);

}  // namespace eigenlight
