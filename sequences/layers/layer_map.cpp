#include "sequences/layers/layer_map.h"

#include <fmt/format.h>

#include <stdexcept>

namespace eigenlight {

std::regex parse_regex(std::string_view option, const std::string& text) {
  try {
    return std::regex(text, std::regex::ECMAScript | std::regex::icase);
  } catch (const std::regex_error&) {
    throw std::invalid_argument(
        fmt::format("{} '{}': not a regular expression (ECMAScript)", option, text));
  }
}

std::string why_unusable(const FileLayer& layer, std::size_t channels) {
  if (layer.is_deep) return "deep data, expected flat pixels";
  if (layer.is_subsampled) return "subsampled channels, expected full resolution";
  if (layer.type == ExrType::kUint) return "integers, expected half or float";
  if (layer.size() < channels) {
    return fmt::format("{} channels, expected {}", layer.size(), channels);
  }
  return {};
}

std::string why_no_light(const FileLayer& layer) {
  return why_unusable(layer, layer.size() == 1 ? 1 : 3);
}

std::vector<MappedLayer> parse_map(const std::vector<std::string>& entries) {
  std::vector<MappedLayer> map;
  for (const std::string& entry : entries) {
    const std::size_t sign = entry.find('=');
    if (sign == std::string::npos) {
      throw std::invalid_argument(
          fmt::format("--map {}: expected ROLE=LAYER, such as albedo=DiffCol", entry));
    }
    map.push_back({parse_role(entry.substr(0, sign)), entry.substr(sign + 1)});
  }
  return map;
}

bool is_called(const FileLayer& layer, const std::string& name) {
  if (layer.name == name || (layer.name.empty() && name == "color")) return true;
  return layer.name.ends_with('.' + name) && !name.empty();
}

}  // namespace eigenlight
