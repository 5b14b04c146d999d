#include "sequences/files/exr_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace eigenlight {
namespace {

struct Aliases {
  std::string_view ours;
  std::array<std::string_view, 5> theirs;  // filled up with empty names
};

// As in files of Cycles, Arnold, RenderMan, V-Ray and pbrt.
constexpr std::array<Aliases, 8> kAliases{{
    {"color", {"", "Combined", "RGBA", "Ci", "Y"}},
    {"albedo", {"DiffCol", "diffuse_albedo", "Albedo", "Denoising Albedo"}},
    {"N", {"Normal", "normal", "Ns", "Denoising Normal"}},
    {"Z", {"Depth", "depth", "zfiltered", "Denoising Depth"}},
    {"P", {"Position", "position"}},
    {"motion", {"Vector", "motionvector", "backward", "Velocity"}},
    {"direct", {"DiffDir", "diffuse_direct"}},
    {"indirect", {"DiffInd", "diffuse_indirect"}},
}};

std::optional<std::string> find_name(const std::vector<std::string>& layers,
                                     std::string_view name) {
  const auto same = std::find(layers.begin(), layers.end(), name);
  if (same != layers.end()) return *same;
  if (name.empty()) return std::nullopt;
  const std::string behind_view = fmt::format(".{}", name);
  const auto in_view = std::find_if(layers.begin(), layers.end(), [&](const std::string& layer) {
    return layer.ends_with(behind_view);
  });
  if (in_view != layers.end()) return *in_view;
  return std::nullopt;
}

}  // namespace

LayerChannel split_channel(std::string_view full_name) {
  const std::size_t dot = full_name.rfind('.');
  if (dot != std::string_view::npos) {
    return {std::string(full_name.substr(0, dot)), std::string(full_name.substr(dot + 1))};
  }
  if (full_name == "R" || full_name == "G" || full_name == "B" || full_name == "A") {
    return {"", std::string(full_name)};
  }
  return {std::string(full_name), ""};
}

int channel_order(std::string_view channel) {
  constexpr std::string_view kOrder = "RGBAXYZW";
  if (channel.size() != 1) return static_cast<int>(kOrder.size());
  const std::size_t position = kOrder.find(channel[0]);
  return static_cast<int>(std::min(position, kOrder.size()));
}

std::optional<std::string> find_layer(const std::vector<std::string>& layers,
                                      std::string_view wanted) {
  if (auto found = find_name(layers, wanted)) return found;
  const auto aliases = std::find_if(kAliases.begin(), kAliases.end(),
                                    [&](const Aliases& a) { return a.ours == wanted; });
  if (aliases == kAliases.end()) return std::nullopt;
  for (std::size_t i = 0; i < aliases->theirs.size(); ++i) {
    const std::string_view name = aliases->theirs[i];
    if (name.empty() && i > 0) break;
    if (auto found = find_name(layers, name)) return found;
  }
  return std::nullopt;
}

}  // namespace eigenlight
