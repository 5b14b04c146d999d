// Tables in Markdown.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace eigenlight {

/// A table with a line for each of `rows`. The first `words` columns are aligned left, the others,
/// which hold numbers, right. A `|` in a cell is escaped. Throws std::invalid_argument if a row has
/// more or fewer cells than `head`.
[[nodiscard]] std::string markdown_table(const std::vector<std::string>& head,
                                         const std::vector<std::vector<std::string>>& rows,
                                         std::size_t words = 1);

}  // namespace eigenlight
