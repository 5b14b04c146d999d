// What a user says about layers.
#pragma once

#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/layers/layer_list.h"
#include "sequences/layers/layer_names.h"

namespace eigenlight {

/// An entry of `--map`, ROLE=LAYER.
struct MappedLayer {
  Role role;
  std::string layer;
  bool is_used = false;
};

/// Throws std::invalid_argument if an entry is not ROLE=LAYER or names no role.
[[nodiscard]] std::vector<MappedLayer> parse_map(const std::vector<std::string>& entries);

/// Whether a user may call the layer so: its full name, or the end of it behind a dot; `color` for
/// bare R, G, B.
[[nodiscard]] bool is_called(const FileLayer& layer, const std::string& name);

/// A regular expression without regard to case. Throws std::invalid_argument naming the option.
[[nodiscard]] std::regex parse_regex(std::string_view option, const std::string& text);

/// Why a layer cannot be used: deep, subsampled, of integers, or less than `channels` channels.
/// Empty if it can.
[[nodiscard]] std::string why_unusable(const FileLayer& layer, std::size_t channels);
/// Why a layer cannot be denoised. Light has 3 channels, or is gray: one.
[[nodiscard]] std::string why_no_light(const FileLayer& layer);

}  // namespace eigenlight
