#include "render/loading/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "frame/float_traps.h"
#include "render/loading/exr_image.h"

namespace eigenlight {
namespace {

using InputPtr = std::unique_ptr<OIIO::ImageInput>;

[[noreturn]] void fail(const std::string& name, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: cannot read image: {}", name, why));
}

/// Reads all channels of the first part, converted to `T`, with the top row first.
template <typename T>
std::vector<T> read_pixels(OIIO::ImageInput& input, OIIO::TypeDesc type, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxSide || spec.height > kMaxSide) {
    fail(name,
         fmt::format("size {}x{}, expected sides in [1, {}]", spec.width, spec.height, kMaxSide));
  }
  std::vector<T> pixels(static_cast<std::size_t>(spec.width) *
                        static_cast<std::size_t>(spec.height) *
                        static_cast<std::size_t>(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, type, pixels.data())) {
    fail(name, input.geterror());
  }
  return pixels;
}

Texture to_texture(OIIO::ImageInput& input, const std::string& name) {
  const auto pixels = read_pixels<std::uint8_t>(input, OIIO::TypeDesc::UINT8, name);
  const auto channels = static_cast<std::size_t>(input.spec().nchannels);
  Texture texture{name, {input.spec().width, input.spec().height}, {}};
  texture.rgba.resize(texture.extent.pixels() * 4);
  for (std::size_t i = 0; i < texture.extent.pixels(); ++i) {
    const std::uint8_t* from = &pixels[i * channels];
    std::uint8_t* to = &texture.rgba[i * 4];
    const bool grey = channels < 3;
    for (std::size_t c = 0; c < 3; ++c) to[c] = from[grey ? 0 : c];
    const bool alpha = channels == 2 || channels >= 4;
    to[3] = alpha ? from[grey ? 1 : 3] : std::uint8_t{255};
  }
  return texture;
}

// 8-bit sRGB of a linear value, for base colors.
std::uint8_t to_srgb(float linear) {
  const float v = std::isgreater(linear, 0.0f) ? std::min(linear, 1.0f) : 0.0f;
  const float s = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * s));
}

Texture exr_texture(const std::filesystem::path& path) {
  const ExrImage image = read_exr_image(path);
  Texture texture{path.string(), image.color[0].extent(), {}};
  for (int y = 0; y < texture.extent.height; ++y) {
    for (int x = 0; x < texture.extent.width; ++x) {
      for (const auto& plane : image.color) texture.rgba.push_back(to_srgb(plane(x, y)));
      const float alpha = image.alpha.empty() ? 1.0f : image.alpha(x, y);
      const float clamped = std::isgreater(alpha, 0.0f) ? std::min(alpha, 1.0f) : 0.0f;
      texture.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * clamped)));
    }
  }
  return texture;
}

// Checks the radiance of the next pixel.
void add_radiance(const glm::vec3& radiance, const std::string& name, Environment& map) {
  for (int c = 0; c < 3; ++c) {
    if (!(radiance[c] >= 0.0f) || std::isinf(radiance[c])) {
      fail(name, fmt::format("pixel {} holds {}, expected a finite radiance >= 0",
                             map.radiance.size(), radiance[c]));
    }
  }
  map.radiance.push_back(radiance);
}

Environment exr_environment(const std::filesystem::path& path, float scale) {
  const ExrImage image = read_exr_image(path);
  Environment map{image.color[0].extent(), {}};
  map.radiance.reserve(map.extent.pixels());
  for (int y = 0; y < map.extent.height; ++y) {
    for (int x = 0; x < map.extent.width; ++x) {
      const glm::vec3 light(image.color[0](x, y), image.color[1](x, y), image.color[2](x, y));
      add_radiance(light * scale, path.string(), map);
    }
  }
  return map;
}

/// Configuration that keeps color from being multiplied by alpha, which only cuts holes here.
OIIO::ImageSpec unassociated() {
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  return config;
}

}  // namespace

Texture read_texture(const std::filesystem::path& path) {
  const FloatTrapsOff threads_of_openimageio_start_here;
  if (is_exr_file(path)) return exr_texture(path);
  const OIIO::ImageSpec config = unassociated();
  const InputPtr input = OIIO::ImageInput::open(path.string(), &config);
  if (!input) fail(path.string(), OIIO::geterror());
  return to_texture(*input, path.string());
}

Texture read_texture(std::span<const std::uint8_t> bytes, const std::string& name) {
  const FloatTrapsOff threads_of_openimageio_start_here;
  OIIO::ImageSpec config = unassociated();
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  // OpenImageIO 2.4 ignores the proxy argument of open() if there is a configuration.
  OIIO::Filesystem::IOProxy* proxy = &memory;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const InputPtr input = OIIO::ImageInput::open(name, &config);
  if (!input) fail(name, OIIO::geterror());
  return to_texture(*input, name);
}

Environment read_environment(const std::filesystem::path& path, float scale) {
  const FloatTrapsOff pixels_may_hold_nan;
  if (is_exr_file(path)) return exr_environment(path, scale);
  const std::string name = path.string();
  const InputPtr input = OIIO::ImageInput::open(name);
  if (!input) fail(name, OIIO::geterror());
  const auto channels = static_cast<std::size_t>(input->spec().nchannels);
  if (channels < 3) fail(name, fmt::format("{} channels, expected 3 (R, G, B)", channels));
  const auto pixels = read_pixels<float>(*input, OIIO::TypeDesc::FLOAT, name);
  Environment map{{input->spec().width, input->spec().height}, {}};
  map.radiance.reserve(map.extent.pixels());
  for (std::size_t i = 0; i < map.extent.pixels(); ++i) {
    const float* p = &pixels[i * channels];
    add_radiance(glm::vec3(p[0], p[1], p[2]) * scale, name, map);
  }
  return map;
}

}  // namespace eigenlight
