#include "render/loading/exr_image.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "sequences/exr/exr_file.h"

namespace eigenlight {
namespace {

// The channel `name` beside channel `of`: of the same layer, part and view.
std::optional<int> beside(const ExrFile& file, const ExrChannelInfo& of, std::string_view name) {
  const std::vector<ExrChannelInfo>& channels = file.channels();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const ExrChannelInfo& channel = channels[i];
    if (channel.channel == name && channel.layer == of.layer && channel.part == of.part &&
        channel.view == of.view) {
      return static_cast<int>(i);
    }
  }
  return std::nullopt;
}

// R, G, B and, if there is one, A.
std::vector<int> find_channels(const ExrFile& file) {
  std::vector<int> found;
  for (const ExrChannelInfo& channel : file.channels()) {
    if (channel.channel != "R" || (!found.empty() && !channel.layer.empty())) continue;
    const auto red = beside(file, channel, "R"), green = beside(file, channel, "G"),
               blue = beside(file, channel, "B"), alpha = beside(file, channel, "A");
    if (!green || !blue) continue;
    found = {*red, *green, *blue};
    if (alpha) found.push_back(*alpha);
    if (channel.layer.empty()) break;
  }
  return found;
}

}  // namespace

bool is_exr_file(const std::filesystem::path& path) {
  constexpr std::array<char, 4> kMagic{0x76, 0x2f, 0x31, 0x01};
  std::array<char, 4> start{};
  std::ifstream file(path, std::ios::binary);
  return file.read(start.data(), start.size()) && start == kMagic;
}

ExrImage read_exr_image(const std::filesystem::path& path) {
  const ExrFile file(path);
  const std::vector<int> channels = find_channels(file);
  if (channels.empty()) {
    throw std::runtime_error(
        fmt::format("{}: cannot read image: no channels R, G, B", path.string()));
  }
  std::vector<Plane<float>> planes = file.read(channels);
  ExrImage image;
  for (std::size_t c = 0; c < 3; ++c) image.color[c] = std::move(planes[c]);
  if (planes.size() > 3) image.alpha = std::move(planes[3]);
  return image;
}

}  // namespace eigenlight
