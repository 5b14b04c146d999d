#include "sequences/pages/page.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "sequences/pages/page/page_sources.h"
#include "sequences/pages/page_json.h"

namespace eigenlight {
namespace {

std::string_view escape_html(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    default:
      return {};
  }
}

// In a script element, `<` could begin the end of the element. In JSON it occurs in strings only.
std::string_view escape_script(char c) { return c == '<' ? "\\u003c" : std::string_view(); }

template <typename Escape>
std::string replaced(std::string_view text, const Escape& escape) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const std::string_view instead = escape(c);
    if (instead.empty()) {
      out += c;
    } else {
      out += instead;
    }
  }
  return out;
}

}  // namespace

PageTable facts_table(std::string title,
                      const std::vector<std::pair<std::string, std::string>>& facts) {
  PageTable table{std::move(title), "", "", {{""}}, {}};
  for (const auto& [name, value] : facts) table.rows.push_back({name, {value}});
  return table;
}

std::string to_html(const Page& page) {
  const std::string title = replaced(page.title, escape_html);
  const std::string data = replaced(
      page_json(page).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace),
      escape_script);
  std::string out;
  out.reserve(kPageHtml.size() + kPageCss.size() + kPageJs.size() + data.size());
  // Only the template is searched for names, never the text that is filled in.
  for (std::string_view rest = kPageHtml;;) {
    const std::size_t open = rest.find("{{");
    out += rest.substr(0, open);
    if (open == std::string_view::npos) return out;
    const std::size_t close = rest.find("}}", open);
    const std::string_view name = rest.substr(open + 2, close - open - 2);
    if (name == "title") out += title;
    if (name == "css") out += kPageCss;
    if (name == "js") out += kPageJs;
    if (name == "data") out += data;
    rest.remove_prefix(close + 2);
  }
}

}  // namespace eigenlight
