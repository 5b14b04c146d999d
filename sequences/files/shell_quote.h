// Words of a command line as a POSIX shell reads them back.
#pragma once

#include <string>

namespace eigenlight {

/// `word` unchanged where a shell reads it as one word, else in single quotes.
[[nodiscard]] std::string quote_for_shell(const std::string& word);

}  // namespace eigenlight
