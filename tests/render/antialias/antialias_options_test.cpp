// Values of the option --aa.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "render/antialias/options.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(AntialiasOptions, ParsingInvertsFormatting) {
  for (const char* text :
       {"none", "lookup", "sraa", "sraa-geometry", "supersample:2", "supersample:1024"}) {
    EXPECT_EQ(format_antialias(parse_antialias(text)), text);
  }
  EXPECT_EQ(parse_antialias("supersample:16").samples, 16);
  EXPECT_EQ(parse_antialias("supersample:16").mode, AntialiasMode::kSupersample);
  EXPECT_EQ(parse_antialias("sraa").mode, AntialiasMode::kSraa);
}

TEST(AntialiasOptions, ErrorListsTheKnownModes) {
  for (const char* text : {"", "fxaa", "Lookup", "lookup:4", "none:", ":", " sraa"}) {
    EXPECT_THAT([&] { (void)parse_antialias(text); },
                ThrowsMessage<std::invalid_argument>(
                    HasSubstr("'; known: none, lookup, sraa, sraa-geometry, supersample:N")))
        << text;
  }
}

TEST(AntialiasOptions, ErrorGivesTheRangeOfSamples) {
  for (const char* text :
       {"supersample", "supersample:", "supersample:1", "supersample:-4", "supersample:1025",
        "supersample:99999999999", "supersample:4x", "supersample:x", "supersample:4:4"}) {
    EXPECT_THAT([&] { (void)parse_antialias(text); },
                ThrowsMessage<std::invalid_argument>(
                    HasSubstr("expected supersample:N with N from 2 to 1024")))
        << text;
  }
}

}  // namespace
}  // namespace eigenlight
