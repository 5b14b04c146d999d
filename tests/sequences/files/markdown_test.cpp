#include "sequences/files/markdown.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace eigenlight {
namespace {

TEST(MarkdownTable, AlignsWordsLeftAndNumbersRight) {
  EXPECT_EQ(markdown_table({"scene", "method", "ms"}, {{"atrium", "`mean`", "3.5"}}, 2),
            "| scene | method | ms |\n| --- | --- | ---: |\n| atrium | `mean` | 3.5 |\n");
}

TEST(MarkdownTable, EscapesBarsInCells) {
  EXPECT_EQ(markdown_table({"a"}, {{"|x|"}}), "| a |\n| --- |\n| \\|x\\| |\n");
}

TEST(MarkdownTable, RefusesRowsOfAnotherLength) {
  EXPECT_THROW((void)markdown_table({"a", "b"}, {{"1"}}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
