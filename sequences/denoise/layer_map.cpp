#include "sequences/denoise/layer_map.h"

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

std::string why_no_light(const FileLayer& layer) {
  if (layer.is_deep) return "deep data; only flat pixels can be denoised";
  if (layer.is_subsampled) return "subsampled channels; only full resolution can be denoised";
  if (layer.type == ExrType::kUint) return "integers";
  if (layer.size() < 3) return fmt::format("{} channels, expected 3", layer.size());
  return {};
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
