// The sources of the pages, from sequences/page/.
#pragma once

#include <string_view>

namespace eigenlight {

/// With {{title}}, {{css}}, {{js}} and {{data}} to be filled in.
extern const std::string_view kPageHtml;
extern const std::string_view kPageCss;
extern const std::string_view kPageJs;

/// The same for pages of page_builder.h.
extern const std::string_view kBuilderHtml;
extern const std::string_view kBuilderCss;
extern const std::string_view kBuilderJs;

}  // namespace eigenlight
