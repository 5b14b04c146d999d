// Lists with commas, as options hold them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace eigenlight {

/// `a,b` as {a, b}; an empty text as no entry. Throws std::invalid_argument naming `option` if an
/// entry is empty or stands there twice.
[[nodiscard]] std::vector<std::string> split_list(std::string_view option, std::string_view text);

/// The same of whole numbers within [low, high].
struct NumberRange {
  int low, high;
};
[[nodiscard]] std::vector<int> split_numbers(std::string_view option, std::string_view text,
                                             NumberRange range);

}  // namespace eigenlight
