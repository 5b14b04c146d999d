#include "sequences/cli/list_commands.h"

#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

#include "render/builtin/builtin_scenes.h"
#include "temporal/methods.h"

namespace eigenlight {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

std::vector<std::string> lines(void (*command)(std::ostream&)) {
  std::stringstream text;
  command(text);
  std::vector<std::string> found;
  for (std::string line; std::getline(text, line);) found.push_back(line);
  return found;
}

/// Column of the text after `name`; npos if no space separates them.
std::size_t text_column(const std::string& line, std::string_view indent, std::string_view name) {
  const std::size_t end = indent.size() + name.size();
  if (line.compare(0, end, std::string(indent).append(name)) != 0) return std::string::npos;
  return line[end] == ' ' ? line.find_first_not_of(' ', end) : std::string::npos;
}

TEST(ListMethods, NamesAndTextsAreAlignedInTwoColumns) {
  const std::vector<std::string> found = lines(list_methods);
  ASSERT_EQ(found.size(), methods().size() + 1);  // and the reference
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < methods().size(); ++i) {
    columns.push_back(text_column(found[i], "", methods()[i].name));
    EXPECT_THAT(found[i], AllOf(HasSubstr(methods()[i].what), HasSubstr(methods()[i].paper)));
  }
  columns.push_back(text_column(found.back(), "", "reference"));
  ASSERT_NE(columns.front(), std::string::npos);
  EXPECT_THAT(columns, Each(columns.front()));
}

TEST(ListParts, PartsFollowTheirMethodInTwoColumns) {
  const std::vector<std::string> found = lines(list_parts);
  const Method& method = methods().front();
  ASSERT_FALSE(method.parts.empty());
  ASSERT_GT(found.size(), method.parts.size());
  EXPECT_EQ(found.front(), method.name);
  for (std::size_t i = 0; i < method.parts.size(); ++i) {
    const std::string& line = found[i + 1];
    const std::size_t column = text_column(line, "  ", method.parts[i].name);
    ASSERT_NE(column, std::string::npos) << line;
    EXPECT_EQ(line.substr(column), method.parts[i].what);
  }
}

TEST(ListScenes, PrintsOneLinePerScene) {
  const std::vector<std::string> found = lines(list_scenes);
  ASSERT_EQ(found.size(), builtin_scenes().size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NE(text_column(found[i], "", builtin_scenes()[i].name), std::string::npos) << found[i];
  }
}

}  // namespace
}  // namespace eigenlight
