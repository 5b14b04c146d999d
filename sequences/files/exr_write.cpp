#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "frame/check.h"
#include "frame/float_traps.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/exr_oiio.h"

namespace eigenlight {
namespace {

OIIO::TypeDesc type_of(ExrType type) {
  switch (type) {
    case ExrType::kHalf:
      return OIIO::TypeHalf;
    case ExrType::kFloat:
      return OIIO::TypeFloat;
    case ExrType::kUint:
      return OIIO::TypeUInt;
  }
  return OIIO::TypeUnknown;
}

Extent extent_of(const ExrChannel& channel) {
  return std::visit([](const auto* plane) { return plane->extent(); }, channel.pixels);
}

void set_attribute(OIIO::ImageSpec& spec, const ExrAttribute& attribute) {
  const std::string name = oiio_name(attribute.name);
  if (const auto* number = std::get_if<int>(&attribute.value)) {
    spec.attribute(name, *number);
  } else if (const auto* real = std::get_if<float>(&attribute.value)) {
    spec.attribute(name, *real);
  } else if (const auto* text = std::get_if<std::string>(&attribute.value)) {
    spec.attribute(name, *text);
  } else {
    spec.attribute(name, OIIO::TypeMatrix, std::get<ExrMatrix>(attribute.value).data());
  }
}

OIIO::ImageSpec make_spec(std::span<const ExrChannel> channels,
                          std::span<const ExrAttribute> attributes) {
  EL_CHECK(!channels.empty(), "an EXR file needs at least one channel");
  const Extent extent = extent_of(channels.front());
  OIIO::ImageSpec spec(extent.width, extent.height, static_cast<int>(channels.size()),
                       OIIO::TypeHalf);
  spec.channelnames.clear();
  for (const ExrChannel& channel : channels) {
    EL_CHECK(extent_of(channel) == extent, "channel '{}' is not of the size of the others",
             channel.name);
    EL_CHECK((channel.type == ExrType::kUint) == (channel.pixels.index() == 1),
             "channel '{}': integers go to uint, floats to half or float", channel.name);
    spec.channelnames.push_back(channel.name);
    spec.channelformats.push_back(type_of(channel.type));
  }
  // Level 4 of 9 against 6: files 1 % larger in 22 % less time (atrium, 640x360, all layers).
  spec.attribute("compression", "zip:4");
  // Without this OpenImageIO writes the time of day, and equal frames would differ in bytes.
  spec.attribute("DateTime", "");
  for (const ExrAttribute& attribute : attributes) set_attribute(spec, attribute);
  return spec;
}

// One channel of all pixels into the pixel-interleaved buffer that OpenImageIO takes.
void pack_channel(const ExrChannel& channel, char* first, std::size_t pixel_bytes) {
  const Extent extent = extent_of(channel);
  for (int y = 0; y < extent.height; ++y) {
    char* to =
        first + static_cast<std::size_t>(y) * static_cast<std::size_t>(extent.width) * pixel_bytes;
    const void* from =
        std::visit([&](const auto* plane) -> const void* { return plane->row(y); }, channel.pixels);
    OIIO::convert_image(1, extent.width, 1, 1, from,
                        channel.type == ExrType::kUint ? OIIO::TypeUInt : OIIO::TypeFloat, 4,
                        OIIO::AutoStride, OIIO::AutoStride, to, type_of(channel.type),
                        static_cast<OIIO::stride_t>(pixel_bytes), OIIO::AutoStride,
                        OIIO::AutoStride);
  }
}

std::vector<char> pack(std::span<const ExrChannel> channels, const OIIO::ImageSpec& spec) {
  const std::size_t pixel_bytes = spec.pixel_bytes(true);
  std::vector<char> pixels(static_cast<std::size_t>(spec.image_pixels()) * pixel_bytes);
  std::size_t offset = 0;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    pack_channel(channels[c], pixels.data() + offset, pixel_bytes);
    offset += spec.channelformats[c].size();
  }
  return pixels;
}

}  // namespace

void write_exr(const std::filesystem::path& path, std::span<const ExrChannel> channels,
               std::span<const ExrAttribute> attributes) {
  const FloatTrapsOff layers_may_hold_nan_and_half_may_overflow;
  use_our_threads_for_exr();
  const OIIO::ImageSpec spec = make_spec(channels, attributes);
  // Encodes to memory: on a full disk our own write then fails, with the system's reason.
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput memory(encoded);
  const auto file = OIIO::ImageOutput::create("exr", &memory);
  if (!file) fail_exr(path.string(), OIIO::geterror());
  const std::vector<char> pixels = pack(channels, spec);
  if (!file->open(path.string(), spec) || !file->write_image(OIIO::TypeUnknown, pixels.data()) ||
      !file->close()) {
    fail_exr(path.string(), file->geterror());
  }
  write_file_atomically(path, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
}

}  // namespace eigenlight
