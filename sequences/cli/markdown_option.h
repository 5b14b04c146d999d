// The option --markdown of commands that print tables.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace eigenlight {

/// Adds `--markdown FILE`, which ends up in `target`.
void add_markdown_option(CLI::App& command, std::string& target);

/// Whether the tables go to standard output instead of a file.
[[nodiscard]] inline bool is_printed(const std::string& target) { return target == "-"; }

/// Writes `text` to the file `target`, if it names one. Throws std::runtime_error naming the file
/// if it cannot be written.
void write_markdown(const std::string& target, const std::string& text);

}  // namespace eigenlight
