#include "sequences/files/markdown.h"

#include "frame/check.h"

namespace eigenlight {
namespace {

std::string line(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) {
    text += ' ';
    for (const char c : cell) text += c == '|' ? std::string("\\|") : std::string(1, c);
    text += " |";
  }
  return text + '\n';
}

}  // namespace

std::string markdown_table(const std::vector<std::string>& head,
                           const std::vector<std::vector<std::string>>& rows, std::size_t words) {
  std::string text = line(head) + '|';
  for (std::size_t i = 0; i < head.size(); ++i) text += i < words ? " --- |" : " ---: |";
  text += '\n';
  for (const std::vector<std::string>& row : rows) {
    EL_CHECK(row.size() == head.size(), "a row of {} cells in a table of {} columns", row.size(),
             head.size());
    text += line(row);
  }
  return text;
}

}  // namespace eigenlight
