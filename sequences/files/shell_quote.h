// Quoting for a POSIX shell.
#pragma once

#include <string>

namespace eigenlight {

/// `word` itself if a shell reads it as one word, else `word` in single quotes.
[[nodiscard]] std::string quote_for_shell(const std::string& word);

}  // namespace eigenlight
