#include "sequences/files/shell_quote.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eigenlight {
namespace {

TEST(QuoteForShell, QuotesWordsThatAShellWouldSplit) {
  EXPECT_EQ(quote_for_shell("out/a-1.exr"), "out/a-1.exr");
  EXPECT_EQ(quote_for_shell("my scene"), "'my scene'");
  EXPECT_EQ(quote_for_shell("it's"), "'it'\\''s'");
  EXPECT_EQ(quote_for_shell(""), "''");
}

}  // namespace
}  // namespace eigenlight
