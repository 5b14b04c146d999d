#include "sequences/report.h"

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sequences/atomic_file.h"
#include "sequences/page_files.h"
#include "sequences/report_data.h"
#include "sequences/report_pictures.h"

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

// Fills {{title}} and so on; what is filled in is not searched again.
std::string fill(std::string_view page, const std::string& title, const std::string& data) {
  std::string out;
  out.reserve(page.size() + kPageCss.size() + kPageJs.size() + data.size());
  while (true) {
    const std::size_t open = page.find("{{");
    if (open == std::string_view::npos) return out += page;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    out += page.substr(0, open);
    if (name == "title") out += title;
    if (name == "css") out += kPageCss;
    if (name == "js") out += kPageJs;
    if (name == "data") out += data;
    page.remove_prefix(close + 2);
  }
}

}  // namespace

void write_report(const std::filesystem::path& dir) {
  ReportData data = read_report_data(dir);
  PictureOptions options;
  options.exposure = data.exposure;
  options.frames_per_second = data.frames_per_second;
  data.page["pictures"] = report_pictures(dir, data.frames, options);
  write_file_atomically(
      dir / "index.html",
      std::string_view(fill(kPageHtml, escape_html(data.title), to_script(data.page))));
}

}  // namespace eigenlight
