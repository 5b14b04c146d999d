// Pixels of chosen channels as planes.
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "frame/bad_file.h"
#include "frame/check.h"
#include "frame/float_traps.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

// Bytes of pixels that one byte of a file can stand for, at most: deflate stores 1032 in one, and
// the lossy ones discard values before that.
double expansion_of(const std::string& compression) {
  if (compression == "none") return 1;
  if (compression == "rle" || compression.starts_with("b44")) return 128;
  if (compression.starts_with("dwa")) return 65536;
  return 2100;
}

template <typename T>
Imf::PixelType type_in_memory() {
  return std::is_same_v<T, float> ? Imf::FLOAT : Imf::UINT;
}

// Decodes one part into planes that have its extent.
template <typename T>
void decode(ExrFile::State& state, int part, const std::vector<std::pair<int, Plane<T>*>>& wanted) {
  const std::lock_guard lock(state.decoding);
  const Imath::Box2i window = state.file->header(part).dataWindow();
  Imf::FrameBuffer frame;
  for (const auto& [channel, plane] : wanted) {
    frame.insert(state.channels[static_cast<std::size_t>(channel)].name,
                 Imf::Slice::Make(type_in_memory<T>(), plane->row(0), window, sizeof(T),
                                  plane->stride() * sizeof(T)));
  }
  if (state.parts[static_cast<std::size_t>(part)].is_tiled) {
    Imf::TiledInputPart tiles(*state.file, part);
    tiles.setFrameBuffer(frame);
    tiles.readTiles(0, tiles.numXTiles(0) - 1, 0, tiles.numYTiles(0) - 1, 0, 0);
  } else {
    Imf::InputPart lines(*state.file, part);
    lines.setFrameBuffer(frame);
    lines.readPixels(window.min.y, window.max.y);
  }
}

const ExrChannelInfo& channel_at(const ExrFile::State& state, int index) {
  EL_CHECK(index >= 0 && index < static_cast<int>(state.channels.size()), "channel {} of {}", index,
           state.channels.size());
  return state.channels[static_cast<std::size_t>(index)];
}

void check_flat(const ExrFile::State& state, const ExrChannelInfo& channel) {
  const std::string path = state.path.string();
  if (state.part_of(channel).is_deep) {
    throw BadFile(state.parts.size() < 2
                      ? fmt::format("{}: deep data, expected flat pixels", path)
                      : fmt::format("{}: channel '{}': deep data, expected flat pixels", path,
                                    channel.full_name));
  }
  if (channel.x_sampling != 1 || channel.y_sampling != 1) {
    throw BadFile(fmt::format("{}: channel '{}' is subsampled {}x{}, expected one value per pixel",
                              path, channel.full_name, channel.x_sampling, channel.y_sampling));
  }
}

template <typename T>
std::vector<Plane<T>> read_planes(ExrFile::State& state, std::span<const int> channels) {
  const FloatTrapsOff channels_may_hold_nan;
  use_our_threads_for_exr();
  std::vector<Plane<T>> planes(channels.size());
  for (int part = 0; part < static_cast<int>(state.parts.size()); ++part) {
    const auto is_here = [&](int c) {
      return state.channels[static_cast<std::size_t>(c)].part == part;
    };
    if (std::none_of(channels.begin(), channels.end(), is_here)) continue;
    state.check_size(part);
    const ExrWindow& window = state.parts[static_cast<std::size_t>(part)].data;
    with_exr_errors(state.path, state.in_part(part) + "cannot read pixels", [&] {
      std::vector<std::pair<int, Plane<T>*>> wanted;
      for (std::size_t i = 0; i < channels.size(); ++i) {
        if (!is_here(channels[i])) continue;
        planes[i] = Plane<T>({window.width, window.height});
        wanted.emplace_back(channels[i], &planes[i]);
      }
      decode(state, part, wanted);
    });
  }
  return planes;
}

}  // namespace

void ExrFile::State::check_size(int part) const {
  const ExrPart& info = parts[static_cast<std::size_t>(part)];
  if (info.data.width > kMaxSide || info.data.height > kMaxSide) {
    throw BadFile(fmt::format("{}: {}data window of {}x{} pixels, expected sides of at most {}",
                              path.string(), in_part(part), info.data.width, info.data.height,
                              kMaxSide));
  }
  double total = 0;
  for (const ExrChannelInfo& c : channels) {
    if (c.part != part) continue;
    total += static_cast<double>(info.data.width) * info.data.height *
             static_cast<double>(bytes_of(c.type)) / c.x_sampling / c.y_sampling;
  }
  if (total > expansion_of(info.compression) * static_cast<double>(bytes->size())) {
    throw std::runtime_error(fmt::format("{}: {}{} bytes are too few for {}x{} pixels",
                                         path.string(), in_part(part), bytes->size(),
                                         info.data.width, info.data.height));
  }
}

std::vector<Plane<float>> ExrFile::read(std::span<const int> channels) const {
  for (const int index : channels) {
    const ExrChannelInfo& channel = channel_at(*state_, index);
    check_flat(*state_, channel);
    if (channel.type == ExrType::kUint) {
      throw BadFile(fmt::format("{}: channel '{}' holds integers, expected half or float",
                                state_->path.string(), channel.full_name));
    }
    EL_CHECK(std::count(channels.begin(), channels.end(), index) == 1, "channel {} twice", index);
  }
  return read_planes<float>(*state_, channels);
}

Plane<std::uint32_t> ExrFile::read_uint(int index) const {
  const ExrChannelInfo& channel = channel_at(*state_, index);
  check_flat(*state_, channel);
  if (channel.type != ExrType::kUint) {
    throw BadFile(fmt::format("{}: channel '{}' is not of type uint", state_->path.string(),
                              channel.full_name));
  }
  return std::move(read_planes<std::uint32_t>(*state_, std::array{index}).front());
}

}  // namespace eigenlight
