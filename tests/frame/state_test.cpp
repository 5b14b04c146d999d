#include "frame/state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace eigenlight {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Plane<float> ramp(Extent extent, int channels) {
  Plane<float> plane(extent, channels);
  for (int y = 0; y < extent.height; ++y) {
    for (int i = 0; i < extent.width * channels; ++i) {
      plane.row(y)[i] = static_cast<float>(100 * y + i);
    }
  }
  return plane;
}

std::string written() {
  StateWriter out;
  out.value("count", 42);
  out.plane("image", ramp({5, 3}, 2));
  out.plane("nothing", Plane<float>());
  return {out.bytes().data(), out.bytes().size()};
}

struct Values {
  int count = 0;
  Plane<float> image, nothing;
};

Values read(const std::string& bytes) {
  Values v;
  StateReader in(bytes);
  in.value("count", v.count);
  in.plane("image", v.image);
  in.plane("nothing", v.nothing);
  in.finish();
  return v;
}

TEST(State, RoundTrips) {
  const Values v = read(written());
  EXPECT_EQ(v.count, 42);
  EXPECT_EQ(v.image.extent(), (Extent{5, 3}));
  EXPECT_EQ(v.image.channels(), 2);
  for (int y = 0; y < 3; ++y) {
    for (int i = 0; i < 10; ++i) EXPECT_EQ(v.image.row(y)[i], static_cast<float>(100 * y + i));
  }
  EXPECT_TRUE(v.nothing.empty());
}

TEST(State, BytesDoNotDependOnPadding) {
  Plane<float> clean = ramp({5, 3}, 1), dirty = clean.clone();
  for (std::size_t i = 5; i < dirty.stride(); ++i) dirty.row(1)[i] = 9.0f;
  StateWriter a, b;
  a.plane("p", clean);
  b.plane("p", dirty);
  EXPECT_EQ(a.bytes(), b.bytes());
}

TEST(State, RejectsEveryTruncation) {
  const std::string whole = written();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW((void)read(whole.substr(0, size)), std::runtime_error) << size << " bytes";
  }
}

TEST(State, RejectsTrailingBytes) {
  EXPECT_THAT([] { (void)read(written() + "x"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("1 bytes too many")));
}

TEST(State, ErrorNamesTheMissingValue) {
  const std::string bytes = written();
  EXPECT_THAT(
      [&] {
        StateReader in(bytes);
        int count = 0;
        in.value("frame", count);
      },
      ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("frame"), HasSubstr("found 'count'"))));
}

TEST(State, RejectsAValueOfAnotherSize) {
  const std::string bytes = written();
  EXPECT_THAT(
      [&] {
        StateReader in(bytes);
        double count = 0;
        in.value("count", count);
      },
      ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("count"), HasSubstr("expected 8"))));
}

TEST(State, RejectsAPlaneOfAnotherShape) {
  StateWriter out;
  out.plane("image", ramp({5, 3}, 2));
  const std::string bytes(out.bytes().data(), out.bytes().size());
  struct Shape {
    Extent extent;
    int channels;
  };
  for (const Shape& shape : {Shape{{3, 5}, 2}, Shape{{5, 3}, 1}, Shape{{6, 3}, 2}}) {
    Plane<float> plane(shape.extent, shape.channels);
    StateReader in(bytes);
    EXPECT_THAT([&] { in.plane("image", plane); },
                ThrowsMessage<std::runtime_error>(HasSubstr("'image': 5x3x2, expected")));
  }
  StateWriter empty;
  empty.plane("image", Plane<float>());
  StateReader in({empty.bytes().data(), empty.bytes().size()});
  Plane<float> plane({5, 3});
  EXPECT_THROW(in.plane("image", plane), std::runtime_error);
}

TEST(State, RejectsAnInvalidBool) {
  StateWriter out;
  out.value("known", std::uint8_t{2});
  StateReader in({out.bytes().data(), out.bytes().size()});
  bool known = false;
  EXPECT_THAT([&] { in.value("known", known); },
              ThrowsMessage<std::runtime_error>(HasSubstr("2, expected 0 or 1")));
}

TEST(State, RejectsDamagedSizesBeforeAllocating) {
  for (const std::int32_t bad : {-1, 0, 65536, 65537, 0x7fffffff}) {
    const std::int32_t shape[3] = {bad, 65536, 64};
    StateWriter out;
    out.value("image", shape);
    StateReader in({out.bytes().data(), out.bytes().size()});
    Plane<float> image;
    EXPECT_THROW(in.plane("image", image), std::runtime_error) << bad;
    EXPECT_TRUE(image.empty());
  }
}

TEST(State, DamagedBytesThrowNoOtherException) {
  const std::string whole = written();
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(~damaged[i]);
    try {
      (void)read(damaged);
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  // All but the payload (count, image) and the number of channels of an image without pixels.
  EXPECT_EQ(refused, static_cast<int>(whole.size()) - 4 - 5 * 3 * 2 * 4 - 4);
}

}  // namespace
}  // namespace eigenlight
