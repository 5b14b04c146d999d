// Layers of EXR files with any channel names, one a line, as the names of our own layers find them.
#include <algorithm>
#include <string>
#include <vector>

#include "sequences/files/exr_layers.h"
#include "tests/fuzz/target.h"

namespace eigenlight {
namespace {

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  for (;;) {
    const std::size_t end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return lines;
    text.remove_prefix(end + 1);
  }
}

bool contains(const std::vector<std::string>& layers, const std::string& name) {
  return std::find(layers.begin(), layers.end(), name) != layers.end();
}

void check_names(std::string_view text) {
  std::vector<std::string> layers;
  for (const std::string& name : lines_of(text)) {
    const LayerChannel split = split_channel(name);
    // No channel of a file may fall out of the mapping.
    FUZZ_CHECK(split.layer.empty() || split.channel.empty()
                   ? split.layer + split.channel == name || "." + split.channel == name ||
                         split.layer + "." == name
                   : split.layer + "." + split.channel == name);
    const int order = channel_order(split.channel);
    FUZZ_CHECK(order >= 0 && order <= 8);
    if (!contains(layers, split.layer)) layers.push_back(split.layer);
  }
  for (const std::string& layer : layers) FUZZ_CHECK(find_layer(layers, layer) == layer);
  for (const char* ours :
       {"color", "albedo", "N", "Z", "P", "motion", "direct", "indirect", "id"}) {
    const auto found = find_layer(layers, ours);
    FUZZ_CHECK(!found || contains(layers, *found));
    FUZZ_CHECK(!contains(layers, ours) || found == ours);
  }
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eigenlight::check_names(eigenlight::as_text(data, size));
  return 0;
}
