#include "sequences/files/split_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace eigenlight {
namespace {

using testing::ElementsAre;

TEST(SplitList, SplitsNamesAndNumbers) {
  EXPECT_TRUE(split_list("x", "").empty());
  EXPECT_THAT(split_list("x", "a,b"), ElementsAre("a", "b"));
  EXPECT_THROW((void)split_list("x", "a,"), std::invalid_argument);
  EXPECT_THROW((void)split_list("x", "a,a"), std::invalid_argument);
  EXPECT_THAT(split_numbers("x", "3,1", {1, 3}), ElementsAre(3, 1));
  for (const char* bad : {"0", "4", "1x", "a", "1,,2"}) {
    EXPECT_THROW((void)split_numbers("x", bad, {1, 3}), std::invalid_argument) << bad;
  }
}

}  // namespace
}  // namespace eigenlight
