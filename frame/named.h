// Lists of things that have names, and the message for a name that is not among them.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace eigenlight {

/// "a, b, c", or "none" if `list` is empty. Its entries are texts, or have a member `name`.
template <typename List>
[[nodiscard]] std::string names_of(const List& list) {
  std::string text;
  for (const auto& entry : list) {
    if (!text.empty()) text += ", ";
    if constexpr (requires { entry.name; }) {
      text += entry.name;
    } else {
      text += entry;
    }
  }
  return text.empty() ? "none" : text;
}

/// The entry of `list` whose member `name` is `name`. Throws std::invalid_argument if there is
/// none: "unknown KIND 'NAME'; known: a, b, c".
template <typename List>
[[nodiscard]] auto& find_named(List& list, std::string_view name, std::string_view kind) {
  for (auto& entry : list) {
    if (entry.name == name) return entry;
  }
  throw std::invalid_argument("unknown " + std::string(kind) + " '" + std::string(name) +
                              "'; known: " + names_of(list));
}

}  // namespace eigenlight
