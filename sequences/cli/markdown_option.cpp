#include "sequences/cli/markdown_option.h"

#include <CLI/CLI.hpp>

#include "sequences/files/atomic_file.h"

namespace eigenlight {

void add_markdown_option(CLI::App& command, std::string& target) {
  command.add_option("--markdown", target,
                     "File for the tables in Markdown; - prints them instead of the usual table");
}

void write_markdown(const std::string& target, const std::string& text) {
  if (!target.empty() && !is_printed(target)) write_file_atomically(target, text);
}

}  // namespace eigenlight
