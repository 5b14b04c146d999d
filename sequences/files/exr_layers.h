// The names of layers in EXR files of several renderers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eigenlight {

/// A full channel name split into layer and channel: `a.b.R` gives {"a.b", "R"}; bare `R`, `G`,
/// `B`, `A` give {"", name}; any other bare name is a layer of its own: {"Z", ""}.
struct LayerChannel {
  std::string layer, channel;
};
[[nodiscard]] LayerChannel split_channel(std::string_view full_name);

/// Order of a channel within its layer: R G B A, X Y Z W, then any other.
[[nodiscard]] int channel_order(std::string_view channel);

/// The entry of `layers` that `wanted` means: the same name, else the same name behind a view layer
/// (`ViewLayer.Normal`), else, for our own names, the name in another renderer, most specific
/// first. Nothing if there is no such entry.
[[nodiscard]] std::optional<std::string> find_layer(const std::vector<std::string>& layers,
                                                    std::string_view wanted);

}  // namespace eigenlight
