#include "sequences/files/exr_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "frame/tiles.h"
#include "sequences/files/atomic_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

Plane<float> ramp(Extent extent, float scale) {
  Plane<float> plane(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      plane(x, y) = scale * static_cast<float>(y * extent.width + x);
    }
  }
  return plane;
}

TEST(ExrIo, ReadsWhatWasWritten) {
  const TempDir dir;
  const Extent extent{37, 19};
  // Multiples of 1/8 below 128 are exact in half precision.
  const Plane<float> red = ramp(extent, 0.125f);
  const Plane<float> green = ramp(extent, 0.0625f);
  const Plane<float> blue = ramp(extent, -0.125f);
  const Plane<float> depth = ramp(extent, 1.0f / 3.0f);
  Plane<std::uint32_t> id(extent);
  id(36, 18) = 0xfffffffeU;
  id(0, 0) = 7;
  const ExrChannel channels[] = {{"R", ExrType::kHalf, &red},
                                 {"G", ExrType::kHalf, &green},
                                 {"B", ExrType::kHalf, &blue},
                                 {"Z", ExrType::kFloat, &depth},
                                 {"id", ExrType::kUint, &id}};
  write_exr(dir / "a.exr", channels, {});

  const ExrReader reader(dir / "a.exr");
  EXPECT_EQ(reader.extent(), extent);
  EXPECT_THAT(reader.layers(), testing::UnorderedElementsAre("", "Z", "id"));
  const Planes<3> color = reader.read_planes<3>("color");
  const Planes<1> z = reader.read_planes<1>("Z");
  const Plane<std::uint32_t> read_id = reader.read_uint("id");
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      ASSERT_EQ(color[0](x, y), red(x, y));
      ASSERT_EQ(color[1](x, y), green(x, y));
      ASSERT_EQ(color[2](x, y), blue(x, y));
      ASSERT_EQ(z[0](x, y), depth(x, y));
      ASSERT_EQ(read_id(x, y), id(x, y));
    }
  }
}

TEST(ExrIo, KeepsNanAndInf) {
  const TempDir dir;
  Plane<float> plane({3, 1});
  plane(0, 0) = std::numeric_limits<float>::quiet_NaN();
  plane(1, 0) = std::numeric_limits<float>::infinity();
  plane(2, 0) = -std::numeric_limits<float>::infinity();
  for (const ExrType type : {ExrType::kHalf, ExrType::kFloat}) {
    const ExrChannel channels[] = {{"noisy.R", type, &plane}};
    write_exr(dir / "a.exr", channels, {});
    const Planes<1> read = ExrReader(dir / "a.exr").read_planes<1>("noisy");
    EXPECT_TRUE(std::isnan(read[0](0, 0)));
    EXPECT_EQ(read[0](1, 0), plane(1, 0));
    EXPECT_EQ(read[0](2, 0), plane(2, 0));
  }
}

TEST(ExrIo, WhatHalfCannotHoldIsClampedAndCounted) {
  const TempDir dir;
  Plane<float> plane({5, 1});
  const float values[] = {65504.0f, 65519.0f, 65520.0f, -1e30f,
                          std::numeric_limits<float>::infinity()};
  for (int x = 0; x < 5; ++x) plane(x, 0) = values[x];
  const ExrChannel half[] = {{"a.R", ExrType::kHalf, &plane}, {"a.G", ExrType::kFloat, &plane}};
  const ExrOverflow overflow = write_exr(dir / "a.exr", half, {});
  EXPECT_EQ(overflow.clamped, 2);
  EXPECT_EQ(overflow.not_finite, 2);  // one in each channel
  const Planes<2> read = ExrReader(dir / "a.exr").read_planes<2>("a");
  for (int x = 0; x < 5; ++x) {
    EXPECT_EQ(read[1](x, 0), plane(x, 0));
    EXPECT_EQ(read[0](x, 0), x == 4 ? plane(4, 0) : x == 3 ? -65504.0f : 65504.0f) << x;
  }
}

TEST(ExrIo, KeepsAttributes) {
  const TempDir dir;
  const Plane<float> plane({2, 2});
  const ExrChannel channels[] = {{"Z", ExrType::kFloat, &plane}};
  ExrMatrix matrix;
  for (std::size_t i = 0; i < 16; ++i) matrix[i] = 0.1f * static_cast<float>(i);
  const ExrAttribute attributes[] = {{"eigenlight.spp", 3},
                                     {"eigenlight.fov_y_degrees", 42.5f},
                                     {"eigenlight.scene", std::string("atrium")},
                                     {"worldToCamera", matrix},
                                     {"worldToNDC", matrix}};
  write_exr(dir / "a.exr", channels, attributes);
  const ExrReader reader(dir / "a.exr");
  for (const ExrAttribute& attribute : attributes) {
    const auto read = reader.attribute(attribute.name);
    ASSERT_TRUE(read.has_value()) << attribute.name;
    EXPECT_EQ(*read, attribute.value) << attribute.name;
  }
  EXPECT_FALSE(reader.attribute("nothing").has_value());
  // The file spells the names as the standard does, for other programs.
  const std::string bytes = read_whole_file(dir / "a.exr");
  EXPECT_THAT(bytes, HasSubstr(std::string("worldToCamera\0m44f", 18)));
  EXPECT_THAT(bytes, HasSubstr(std::string("worldToNDC\0m44f", 15)));
}

TEST(ExrIo, BytesAreEqualForAnyNumberOfThreads) {
  const TempDir dir;
  const Plane<float> plane = ramp({190, 107}, 0.37f);
  const ExrChannel channels[] = {{"R", ExrType::kHalf, &plane}, {"Z", ExrType::kFloat, &plane}};
  set_thread_count(1);
  write_exr(dir / "one.exr", channels, {});
  set_thread_count(3);
  write_exr(dir / "three.exr", channels, {});
  set_thread_count(0);
  EXPECT_TRUE(read_whole_file(dir / "one.exr") == read_whole_file(dir / "three.exr"));
}

TEST(ExrIo, ErrorsNameFileAndLayer) {
  const TempDir dir;
  EXPECT_THAT([&] { (void)ExrReader(dir / "none.exr"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.exr: no such file")));
  std::ofstream(dir / "text.exr") << "not an image";
  EXPECT_THAT([&] { (void)ExrReader(dir / "text.exr"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("text.exr: cannot read")));

  const Plane<float> plane = ramp({64, 64}, 0.31f);
  const ExrChannel channels[] = {{"albedo.R", ExrType::kHalf, &plane},
                                 {"Z", ExrType::kFloat, &plane}};
  write_exr(dir / "a.exr", channels, {});
  const ExrReader reader(dir / "a.exr");
  EXPECT_THAT(
      [&] { (void)reader.read("motion"); },
      ThrowsMessage<std::runtime_error>(HasSubstr("a.exr: no layer 'motion'; it has: Z, albedo")));
  EXPECT_THAT([&] { (void)reader.read_planes<3>("albedo"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'albedo' has 1 channels, expected 3")));
  EXPECT_THAT([&] { (void)reader.read_uint("Z"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("channel 'Z' is not of type uint")));

  // A truncated file is an error of any kind, never pixels.
  const std::string bytes = read_whole_file(dir / "a.exr");
  write_file_atomically(dir / "short.exr", bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT([&] { (void)ExrReader(dir / "short.exr").read("Z"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("short.exr: ")));
}

TEST(ExrIo, PlanesOfDifferentSizesAreAnError) {
  const TempDir dir;
  const Plane<float> a({4, 4});
  const Plane<float> b({4, 5});
  const ExrChannel channels[] = {{"R", ExrType::kHalf, &a}, {"G", ExrType::kHalf, &b}};
  EXPECT_THROW(write_exr(dir / "a.exr", channels, {}), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

}  // namespace
}  // namespace eigenlight
