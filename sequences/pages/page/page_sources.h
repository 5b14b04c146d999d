// The parts of a page that are the same in all pages, from the files of this folder.
#pragma once

#include <string_view>

namespace eigenlight {

/// With {{title}}, {{css}}, {{js}} and {{data}} to be filled in.
extern const std::string_view kPageHtml;
extern const std::string_view kPageCss;
extern const std::string_view kPageJs;

}  // namespace eigenlight
