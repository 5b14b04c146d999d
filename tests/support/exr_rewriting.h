// Files to rewrite, and how two of them are compared.
#pragma once

#include <Imath/half.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOpaqueAttribute.h>
#include <OpenEXR/ImfPreviewImage.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sequences/exr/exr_file.h"
#include "tests/support/exr_core.h"
#include "tests/support/exr_maker.h"

namespace eigenlight {

inline const Imath::Box2i kDisplay(Imath::V2i(0, 0), Imath::V2i(59, 49));
inline const Imath::Box2i kBeyond(Imath::V2i(-6, 4), Imath::V2i(70, 103));

// Multiples of 1/8 below 256: exact in half.
inline Plane<float> new_pixels(const ExrFile& file, int channel) {
  const ExrChannelInfo& info = file.channels()[static_cast<std::size_t>(channel)];
  const ExrWindow& window = file.parts()[static_cast<std::size_t>(info.part)].data;
  Plane<float> plane({window.width, window.height});
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      plane(x, y) = 0.125f * static_cast<float>((x * 7 + y * 13 + channel) % 2000);
    }
  }
  return plane;
}

inline int index_of(const ExrFile& file, const std::string& full_name) {
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    if (file.channels()[i].full_name == full_name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no channel " << full_name;
  return 0;
}

inline std::string half_bytes(const Plane<float>& plane) {
  std::string bytes;
  for (int y = 0; y < plane.height(); ++y) {
    for (int x = 0; x < plane.width(); ++x) {
      const std::uint16_t bits = Imath::half(plane(x, y)).bits();
      bytes.append(reinterpret_cast<const char*>(&bits), 2);
    }
  }
  return bytes;
}

inline void expect_equal_but(const std::filesystem::path& in, const std::filesystem::path& out,
                             const std::vector<std::string>& replaced) {
  EXPECT_THAT(differences(CoreReader::read(in.string()), CoreReader::read(out.string()), replaced),
              testing::IsEmpty());
}

// Channels of all types, one of them half and named as light is.
inline Imf::Header mixed_header(Imf::Compression compression, Imf::LineOrder order) {
  Imf::Header header = exr_header(kDisplay, kBeyond, compression, order);
  for (const char* name :
       {"R", "albedo.R", "a layer whose name is much longer than 31 letters.R"}) {
    header.channels().insert(name, Imf::Channel(Imf::HALF));
  }
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  Imf::OpaqueAttribute unknown("a type of ours");
  header.insert("unknown", unknown);
  header.insert("frame", Imf::IntAttribute(7));
  header.setPreviewImage(Imf::PreviewImage(3, 2));
  Imf::addChromaticities(header, Imf::Chromaticities());
  return header;
}

}  // namespace eigenlight
