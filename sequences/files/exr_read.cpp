#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "frame/bad_file.h"
#include "frame/float_traps.h"
#include "frame/named.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/exr_layers.h"
#include "sequences/files/exr_oiio.h"

namespace eigenlight {
namespace {

using Value = std::variant<int, float, std::string, ExrMatrix>;

// Copies one channel, every `step`-th value of the data window, to its place in the display window.
template <typename T>
Plane<T> place(const OIIO::ImageSpec& spec, const T* window, int step) {
  Plane<T> plane({spec.full_width, spec.full_height});
  const int dx = spec.x - spec.full_x;
  const int dy = spec.y - spec.full_y;
  for (int y = 0; y < spec.height; ++y) {
    for (int x = 0; x < spec.width; ++x, window += step) {
      if (plane.extent().contains(x + dx, y + dy)) plane(x + dx, y + dy) = *window;
    }
  }
  return plane;
}

}  // namespace

struct Channel {
  std::string name;    // full
  std::string suffix;  // within its layer
  int part = 0, index = 0;
  OIIO::TypeDesc type;
};

struct ExrReader::State {
  std::string path;
  std::unique_ptr<OIIO::ImageInput> file;
  std::vector<OIIO::ImageSpec> parts;
  std::vector<Channel> found;
  std::vector<std::string> channels, layers, channel_layers;

  void add_part(const OIIO::ImageSpec& spec);
  [[nodiscard]] std::vector<Channel> channels_of(std::string_view layer) const;
  template <typename T>
  [[nodiscard]] std::vector<Plane<T>> read(const std::vector<Channel>& wanted,
                                           OIIO::TypeDesc type) const;
};

void ExrReader::State::add_part(const OIIO::ImageSpec& spec) {
  const int part = static_cast<int>(parts.size());
  const std::string part_name = spec.get_string_attribute("name");
  for (int c = 0; c < spec.nchannels; ++c) {
    std::string name = spec.channelnames[static_cast<std::size_t>(c)];
    // Without the part name, bare channels of all parts would be called R, G, B.
    if (part > 0 && !part_name.empty() && !name.starts_with(part_name + ".")) {
      name = fmt::format("{}.{}", part_name, name);
    }
    LayerChannel split = split_channel(name);
    if (std::find(layers.begin(), layers.end(), split.layer) == layers.end()) {
      layers.push_back(split.layer);
    }
    channels.push_back(name);
    channel_layers.push_back(split.layer);
    found.push_back({std::move(name), std::move(split.channel), part, c, spec.channelformat(c)});
  }
  parts.push_back(spec);
}

std::vector<Channel> ExrReader::State::channels_of(std::string_view layer) const {
  const auto resolved = find_layer(layers, layer);
  if (!resolved) {
    std::vector<std::string> names = layers;
    std::replace(names.begin(), names.end(), std::string(), std::string("color"));
    throw BadFile(fmt::format("{}: no layer '{}'; it has: {}", path, layer, names_of(names)));
  }
  std::vector<Channel> chosen;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (channel_layers[i] == *resolved) chosen.push_back(found[i]);
  }
  std::stable_sort(chosen.begin(), chosen.end(), [](const Channel& a, const Channel& b) {
    return channel_order(a.suffix) < channel_order(b.suffix);
  });
  return chosen;
}

template <typename T>
std::vector<Plane<T>> ExrReader::State::read(const std::vector<Channel>& wanted,
                                             OIIO::TypeDesc type) const {
  const FloatTrapsOff layers_may_hold_nan;
  const auto [low, high] =
      std::minmax_element(wanted.begin(), wanted.end(),
                          [](const Channel& a, const Channel& b) { return a.index < b.index; });
  const OIIO::ImageSpec& spec = parts[static_cast<std::size_t>(low->part)];
  const int step = high->index + 1 - low->index;
  std::vector<T> window(static_cast<std::size_t>(spec.image_pixels()) *
                        static_cast<std::size_t>(step));
  // One call for all channels: each call decodes every channel of its lines.
  if (!file->read_image(low->part, 0, low->index, high->index + 1, type, window.data())) {
    fail_exr(path, fmt::format("channel '{}': {}", low->name, file->geterror()));
  }
  std::vector<Plane<T>> planes;
  for (const Channel& channel : wanted) {
    planes.push_back(place<T>(spec, window.data() + (channel.index - low->index), step));
  }
  return planes;
}

ExrReader::ExrReader(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
  const FloatTrapsOff threads_of_openexr_start_here;
  use_our_threads_for_exr();
  state_->path = path.string();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) fail_exr(state_->path, "no such file");
  state_->file = OIIO::ImageInput::create("exr");
  OIIO::ImageSpec spec;
  if (!state_->file || !state_->file->open(state_->path, spec)) {
    fail_exr(state_->path, fmt::format("cannot read: {}",
                                       state_->file ? state_->file->geterror() : OIIO::geterror()));
  }
  for (int part = 0; state_->file->seek_subimage(part, 0); ++part) {
    state_->add_part(state_->file->spec());
  }
  // Seeking past the last part leaves an error message; drop it.
  (void)state_->file->geterror();
}

ExrReader::~ExrReader() = default;
ExrReader::ExrReader(ExrReader&&) noexcept = default;
ExrReader& ExrReader::operator=(ExrReader&&) noexcept = default;

Extent ExrReader::extent() const {
  return {state_->parts.front().full_width, state_->parts.front().full_height};
}
const std::vector<std::string>& ExrReader::channels() const { return state_->channels; }
const std::vector<std::string>& ExrReader::layers() const { return state_->layers; }
bool ExrReader::has_layer(std::string_view layer) const {
  return find_layer(state_->layers, layer).has_value();
}

std::vector<Plane<float>> ExrReader::read(std::string_view layer) const {
  const std::vector<Channel> channels = state_->channels_of(layer);
  for (const Channel& channel : channels) {
    if (channel.type == OIIO::TypeUInt) {
      throw BadFile(fmt::format("{}: channel '{}' holds integers, expected half or float",
                                state_->path, channel.name));
    }
  }
  return state_->read<float>(channels, OIIO::TypeFloat);
}

Plane<std::uint32_t> ExrReader::read_uint(std::string_view layer) const {
  const std::vector<Channel> channels = state_->channels_of(layer);
  check_channels(layer, channels.size(), 1);
  if (channels.front().type != OIIO::TypeUInt) {
    throw BadFile(
        fmt::format("{}: channel '{}' is not of type uint", state_->path, channels.front().name));
  }
  return std::move(state_->read<std::uint32_t>({channels.front()}, OIIO::TypeUInt).front());
}

std::optional<Value> ExrReader::attribute(const std::string& name) const {
  const OIIO::ParamValue* found = state_->parts.front().find_attribute(oiio_name(name));
  if (!found) return std::nullopt;
  if (found->type() == OIIO::TypeInt) return found->get_int();
  if (found->type() == OIIO::TypeFloat) return found->get_float();
  if (found->type() == OIIO::TypeMatrix) {
    ExrMatrix matrix;
    std::memcpy(matrix.data(), found->data(), sizeof(matrix));
    return matrix;
  }
  return found->get_string();
}

void ExrReader::check_channels(std::string_view layer, std::size_t found,
                               std::size_t wanted) const {
  if (found >= wanted) return;
  throw BadFile(fmt::format("{}: layer '{}' has {} channels, expected {}", state_->path, layer,
                            found, wanted));
}

}  // namespace eigenlight
