// Pages that need no other file.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace eigenlight {

struct PageParts {
  std::string_view html;  ///< with {{title}}, {{css}}, {{js}} and {{data}} to be filled in
  std::string_view css, js;
};

/// The page; `title` is plain text. `data` stands in it as JSON for the script to read; bytes that
/// are no UTF-8 are replaced.
[[nodiscard]] std::string fill_page(const PageParts& parts, std::string_view title,
                                    const nlohmann::ordered_json& data);

}  // namespace eigenlight
