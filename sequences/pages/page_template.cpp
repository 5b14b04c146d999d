#include "sequences/pages/page_template.h"

#include <nlohmann/json.hpp>

namespace eigenlight {
namespace {

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// JSON inside a script element: `<` could end the element, and stands in strings only.
std::string to_script(const nlohmann::ordered_json& json) {
  using Handler = nlohmann::ordered_json::error_handler_t;
  const std::string text = json.dump(-1, ' ', false, Handler::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string fill_page(const PageParts& parts, std::string_view title,
                      const nlohmann::ordered_json& data) {
  const std::string escaped = escape_html(title), script = to_script(data);
  std::string_view page = parts.html;
  std::string out;
  out.reserve(page.size() + parts.css.size() + parts.js.size() + script.size());
  // What is filled in is not searched again.
  while (true) {
    const std::size_t open = page.find("{{");
    if (open == std::string_view::npos) return out += page;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    out += page.substr(0, open);
    if (name == "title") out += escaped;
    if (name == "css") out += parts.css;
    if (name == "js") out += parts.js;
    if (name == "data") out += script;
    page.remove_prefix(close + 2);
  }
}

}  // namespace eigenlight
