#include "sequences/files/ldr_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "frame/float_traps.h"

namespace eigenlight {

bool is_ldr_name(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

Planes<3> read_ldr_image(const std::filesystem::path& path) {
  const FloatTrapsOff threads_of_openimageio_start_here;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw std::runtime_error(fmt::format("{}: no such file", path.string()));
  }
  // Else colors are multiplied by alpha.
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const auto file = OIIO::ImageInput::open(path.string(), &as_stored);
  if (!file) throw std::runtime_error(fmt::format("{}: {}", path.string(), OIIO::geterror()));
  const OIIO::ImageSpec& spec = file->spec();
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<float> values(static_cast<std::size_t>(spec.image_pixels()) * channels);
  if (!file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, values.data())) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), file->geterror()));
  }
  Planes<3> planes = make_planes<3>({spec.width, spec.height});
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t source = channels >= 3 ? c : 0;
    for (int y = 0; y < spec.height; ++y) {
      for (int x = 0; x < spec.width; ++x) {
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(spec.width) +
            static_cast<std::size_t>(x);
        planes[c](x, y) = values[pixel * channels + source];
      }
    }
  }
  return planes;
}

std::vector<unsigned char> encode_jpeg(const Plane<std::uint8_t>& rgb, int quality) {
  EL_CHECK(rgb.channels() == 3, "a JPEG picture needs 3 values a pixel, not {}", rgb.channels());
  EL_CHECK(quality >= 1 && quality <= 100, "JPEG quality {}: must be in [1, 100]", quality);
  const FloatTrapsOff threads_of_openimageio_start_here;
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::ImageSpec spec(rgb.width(), rgb.height(), 3, OIIO::TypeUInt8);
  spec.attribute("Compression", fmt::format("jpeg:{}", quality));
  const auto file = OIIO::ImageOutput::create("jpg", &memory);
  const auto row_bytes = static_cast<OIIO::stride_t>(rgb.stride());
  if (!file || !file->open("picture.jpg", spec) ||
      !file->write_image(OIIO::TypeUInt8, rgb.row(0), OIIO::AutoStride, row_bytes) ||
      !file->close()) {
    throw std::runtime_error(
        fmt::format("cannot encode a picture: {}", file ? file->geterror() : OIIO::geterror()));
  }
  return bytes;
}

std::string jpeg_data_uri(const std::vector<unsigned char>& jpeg) {
  const OIIO::string_view bytes(reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
  return "data:image/jpeg;base64," + OIIO::Strutil::base64_encode(bytes);
}

}  // namespace eigenlight
