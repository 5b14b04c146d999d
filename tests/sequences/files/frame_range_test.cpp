#include "sequences/files/frame_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(FrameRange, ParsesAllForms) {
  EXPECT_THAT(parse_frame_range("7"), ElementsAre(7));
  EXPECT_THAT(parse_frame_range("1-4"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(parse_frame_range("1-3,20-22"), ElementsAre(1, 2, 3, 20, 21, 22));
  EXPECT_THAT(parse_frame_range("1-12x5"), ElementsAre(1, 6, 11));
  EXPECT_THAT(parse_frame_range("-2-1"), ElementsAre(-2, -1, 0, 1));
  EXPECT_THAT(parse_frame_range("-3--5"), ElementsAre(-3, -4, -5));
  EXPECT_THAT(parse_frame_range("5-1"), ElementsAre(5, 4, 3, 2, 1));
  EXPECT_THAT(parse_frame_range("10-1x4"), ElementsAre(10, 6, 2));
  EXPECT_EQ(parse_frame_range("-10-100").size(), 111u);
}

TEST(FrameRange, ErrorsNameTheWrongPart) {
  for (const char* text : {"", "a", "1-", "1-2x", "1-2x0", "1-2x-1", "1,,2", "1,", "1 - 2", "1.5",
                           "99999999999", "1-2-3", "x5"}) {
    EXPECT_THROW((void)parse_frame_range(text), std::invalid_argument) << text;
  }
  EXPECT_THAT([] { (void)parse_frame_range("1-5,6-q"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'6-q'")));
  EXPECT_THAT([] { (void)parse_frame_range("1-10,5-7"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("frame 5 is named twice")));
  EXPECT_THAT([] { (void)parse_frame_range("0-9000000"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("more than 1000000 frames")));
}

TEST(FrameRange, FormattingReturnsTheParsedText) {
  for (const char* text : {"7", "1-10", "1-3,20-22", "1-11x5", "-2-1", "5-1", "10-2x4", "1,9"}) {
    EXPECT_EQ(format_frame_range(parse_frame_range(text)), text);
  }
}

}  // namespace
}  // namespace eigenlight
