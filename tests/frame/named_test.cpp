#include "frame/named.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace eigenlight {
namespace {

struct Entry {
  std::string_view name;
  int value;
};

TEST(Named, NamesAreJoinedWithCommas) {
  EXPECT_EQ(names_of(std::vector<Entry>{{"a", 1}, {"b", 2}}), "a, b");
  EXPECT_EQ(names_of(std::vector<std::string_view>{"x", "y", "z"}), "x, y, z");
  EXPECT_EQ(names_of(std::vector<Entry>{}), "none");
}

TEST(Named, FindsAnEntryByItsName) {
  const std::vector<Entry> list{{"a", 1}, {"b", 2}};
  EXPECT_EQ(&find_named(list, "b", "letter"), &list[1]);
}

TEST(Named, UnknownNameListsKnownNames) {
  const std::vector<Entry> list{{"a", 1}, {"b", 2}};
  EXPECT_THAT([&] { (void)find_named(list, "c", "letter"); },
              testing::ThrowsMessage<std::invalid_argument>("unknown letter 'c'; known: a, b"));
}

}  // namespace
}  // namespace eigenlight
