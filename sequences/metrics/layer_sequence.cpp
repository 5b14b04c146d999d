#include "sequences/metrics/layer_sequence.h"

#include <system_error>
#include <vector>

#include "sequences/files/exr_layers.h"

namespace eigenlight {

LayerSequence parse_layer_sequence(const std::string& text) {
  const std::size_t colon = text.rfind(".exr:");
  std::error_code error;
  if (colon == std::string::npos || std::filesystem::is_regular_file(text, error)) {
    return {SequenceName(text), {}};
  }
  return {SequenceName(text.substr(0, colon + 4)), text.substr(colon + 5)};
}

std::string prefixed_layer(const ExrReader& reader, const std::string& asked,
                           const std::string& prefix) {
  if (prefix.empty()) return asked;
  std::vector<std::string> layers;
  for (const std::string& layer : reader.layers()) {
    if (layer.starts_with(prefix + '.')) layers.push_back(layer.substr(prefix.size() + 1));
  }
  return prefix + '.' + find_layer(layers, asked).value_or(asked);
}

Planes<3> read_layer(const LayerSequence& sequence, int frame, const std::string& layer) {
  const ExrReader reader(sequence.name.path(frame));
  return reader.read_planes<3>(prefixed_layer(reader, layer, sequence.prefix));
}

}  // namespace eigenlight
