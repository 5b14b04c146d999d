#include "sequences/files/file_pattern.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace eigenlight {
namespace {

TEST(FilePattern, NameHoldsTheFrameNumber) {
  EXPECT_EQ(FilePattern("frame.####.exr").name(12), "frame.0012.exr");
  EXPECT_EQ(FilePattern("a.#.exr").name(12), "a.0012.exr");
  EXPECT_EQ(FilePattern("a.##.exr").name(123), "a.123.exr");
  EXPECT_EQ(FilePattern("a.@@@.exr").name(7), "a.007.exr");
  EXPECT_EQ(FilePattern("a.@.exr").name(12), "a.12.exr");
  EXPECT_EQ(FilePattern("a.%04d.exr").name(12), "a.0012.exr");
  EXPECT_EQ(FilePattern("a%d").name(12), "a12");
  EXPECT_EQ(FilePattern("50%.###").name(1), "50%.001");
  EXPECT_EQ(FilePattern("a.####").name(-10), "a.-010");
}

TEST(FilePattern, FrameNumberIsReadFromAName) {
  const FilePattern pattern("frame.####.exr");
  for (const int frame : {-10, 0, 7, 9999, 10000, 123456}) {
    EXPECT_EQ(pattern.frame(pattern.name(frame)), frame);
  }
  for (const char* name : {"frame.12.exr", "frame..exr", "frame.00012.exr", "frame.0012.exr.tmp",
                           ".frame.0012.exr", "frame.0x12.exr", "frame.exr"}) {
    EXPECT_EQ(pattern.frame(name), std::nullopt) << name;
  }
}

TEST(FilePattern, PatternNeedsExactlyOnePlace) {
  EXPECT_THROW(FilePattern("frame.exr"), std::invalid_argument);
  EXPECT_THROW(FilePattern("##.##"), std::invalid_argument);
  EXPECT_THROW(FilePattern("#.%d"), std::invalid_argument);
  EXPECT_THROW(FilePattern("%s"), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
