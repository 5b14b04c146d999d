// How renderers name the layers of their EXR files.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eigenlight {

/// The layer of a full channel name and what is left of the name: `a.b.R` gives {"a.b", "R"}; bare
/// `R`, `G`, `B`, `A` give {"", name}; any other bare name is a layer of its own: {"Z", ""}.
struct LayerChannel {
  std::string layer, channel;
};
[[nodiscard]] LayerChannel split_channel(std::string_view full_name);

/// Order of a channel within its layer: R G B A, X Y Z W, then all others.
[[nodiscard]] int channel_order(std::string_view channel);

/// The one of `layers` that `wanted` means: the same name, else the same name behind a view layer
/// (`ViewLayer.Normal`), else, for our own names, what other renderers call it, most specific
/// first. Nothing if there is none.
[[nodiscard]] std::optional<std::string> find_layer(const std::vector<std::string>& layers,
                                                    std::string_view wanted);

}  // namespace eigenlight
