#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "frame/bad_file.h"
#include "frame/named.h"
#include "sequences/exr/exr_colors.h"
#include "sequences/exr/exr_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/exr_layers.h"
#include "sequences/files/machine.h"

namespace eigenlight {
namespace {

// Values of the data window at their places in the display window.
template <typename T>
Plane<T> place(Plane<T> window, const ExrWindow& data, const ExrWindow& display) {
  if (data == display) return window;
  Plane<T> plane({display.width, display.height});
  const int x0 = std::max(data.x, display.x);
  const int x1 = std::min(data.x + data.width, display.x + display.width);
  const int y0 = std::max(data.y, display.y);
  const int y1 = std::min(data.y + data.height, display.y + display.height);
  for (int y = y0; y < y1 && x0 < x1; ++y) {
    std::copy_n(window.at(x0 - data.x, y - data.y), x1 - x0,
                plane.at(x0 - display.x, y - display.y));
  }
  return plane;
}

}  // namespace

struct ExrReader::State {
  explicit State(const std::filesystem::path& path) : file(path) {}

  ExrFile file;
  std::vector<LayerChannel> names;            // of each channel of the file
  std::vector<std::string> channels, layers;  // full names; layers in the order of their first

  [[nodiscard]] std::string path() const { return file.path().string(); }
  /// The channels of a layer as indices of the file's.
  [[nodiscard]] std::vector<int> channels_of(std::string_view layer) const;
  template <typename T>
  [[nodiscard]] Plane<T> to_display(Plane<T> plane, int channel) const;
};

std::vector<int> ExrReader::State::channels_of(std::string_view layer) const {
  const auto resolved = find_layer(layers, layer);
  if (!resolved) {
    std::vector<std::string> known = layers;
    std::replace(known.begin(), known.end(), std::string(), std::string("color"));
    throw BadFile(fmt::format("{}: no layer '{}'; it has: {}", path(), layer, names_of(known)));
  }
  std::vector<int> chosen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].layer == *resolved) chosen.push_back(static_cast<int>(i));
  }
  const auto order = [&](int c) {
    return channel_order(names[static_cast<std::size_t>(c)].channel);
  };
  std::stable_sort(chosen.begin(), chosen.end(), [&](int a, int b) { return order(a) < order(b); });
  return chosen;
}

template <typename T>
Plane<T> ExrReader::State::to_display(Plane<T> plane, int channel) const {
  const ExrWindow& display = file.display_window();
  if (display.width > kMaxSide || display.height > kMaxSide) {
    throw BadFile(fmt::format("{}: display window of {}x{} pixels, expected sides of at most {}",
                              path(), display.width, display.height, kMaxSide));
  }
  const int part = file.channels()[static_cast<std::size_t>(channel)].part;
  // A header of a few bytes must not take all memory: three channels, and as much for work on them.
  const double needed = 24.0 * static_cast<double>(display.width) * display.height;
  if (needed > machine_memory()) {
    throw std::runtime_error(
        fmt::format("{}: display window of {}x{} pixels needs about {:.0f} GB of memory, this "
                    "machine has {:.0f}",
                    path(), display.width, display.height, needed * 1e-9, machine_memory() * 1e-9));
  }
  try {
    return place(std::move(plane), file.parts()[static_cast<std::size_t>(part)].data, display);
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(fmt::format("{}: not enough memory for {}x{} pixels", path(),
                                         display.width, display.height));
  }
}

ExrReader::ExrReader(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {
  for (const ExrChannelInfo& channel : state_->file.channels()) {
    state_->channels.push_back(channel.part == 0 ? channel.name : channel.full_name);
    state_->names.push_back(split_channel(state_->channels.back()));
    const std::string& layer = state_->names.back().layer;
    if (std::find(state_->layers.begin(), state_->layers.end(), layer) == state_->layers.end()) {
      state_->layers.push_back(layer);
    }
  }
}

ExrReader::~ExrReader() = default;
ExrReader::ExrReader(ExrReader&&) noexcept = default;
ExrReader& ExrReader::operator=(ExrReader&&) noexcept = default;

Extent ExrReader::extent() const {
  return {state_->file.display_window().width, state_->file.display_window().height};
}
const std::vector<std::string>& ExrReader::channels() const { return state_->channels; }
const std::vector<std::string>& ExrReader::layers() const { return state_->layers; }
bool ExrReader::has_layer(std::string_view layer) const {
  return find_layer(state_->layers, layer).has_value();
}

std::vector<Plane<float>> ExrReader::read(std::string_view layer) const {
  const std::vector<int> channels = state_->channels_of(layer);
  std::vector<Plane<float>> planes = state_->file.read(channels);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    planes[i] = state_->to_display(std::move(planes[i]), channels[i]);
  }
  return planes;
}

Planes<3> ExrReader::read_colors(std::string_view layer) const {
  std::vector<Plane<float>> found = read(layer);
  if (found.size() == 2) check_channels(layer, 2, 3);
  Planes<3> planes;
  for (std::size_t c = 3; c-- > 0;) {
    planes[c] = found.size() >= 3 || c == 0 ? std::move(found[c]) : found[0].clone();
  }
  return planes;
}

ExrWindow ExrReader::data_window(std::string_view layer) const {
  const auto channel = static_cast<std::size_t>(state_->channels_of(layer).front());
  const auto part = static_cast<std::size_t>(state_->file.channels()[channel].part);
  ExrWindow window = state_->file.parts()[part].data;
  window.x -= state_->file.display_window().x;
  window.y -= state_->file.display_window().y;
  return window;
}

ExrChromaticities ExrReader::chromaticities() const {
  const std::optional<ExrValue> found = state_->file.attribute("chromaticities");
  const auto* colors = found ? std::get_if<ExrChromaticities>(&*found) : nullptr;
  return colors ? *colors : rec709_chromaticities();
}

Plane<std::uint32_t> ExrReader::read_uint(std::string_view layer) const {
  const std::vector<int> channels = state_->channels_of(layer);
  check_channels(layer, channels.size(), 1);
  return state_->to_display(state_->file.read_uint(channels.front()), channels.front());
}

std::optional<std::variant<int, float, std::string, ExrMatrix>> ExrReader::attribute(
    const std::string& name) const {
  const std::optional<ExrValue> found = state_->file.attribute(name);
  if (!found) return std::nullopt;
  if (const auto* number = std::get_if<int>(&*found)) return *number;
  if (const auto* real = std::get_if<float>(&*found)) return *real;
  if (const auto* text = std::get_if<std::string>(&*found)) return *text;
  if (const auto* matrix = std::get_if<ExrMatrix>(&*found)) return *matrix;
  return std::nullopt;
}

void ExrReader::check_channels(std::string_view layer, std::size_t found,
                               std::size_t wanted) const {
  if (found >= wanted) return;
  throw BadFile(fmt::format("{}: layer '{}' has {} channels, expected {}", state_->path(), layer,
                            found, wanted));
}

}  // namespace eigenlight
