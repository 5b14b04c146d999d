// Paths that are no files, and files that end too soon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "sequences/exr/exr_file.h"
#include "sequences/exr/exr_rewrite.h"
#include "sequences/exr/exr_write.h"
#include "sequences/files/atomic_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ExrFile, DirectoriesAndPipesAreNotRead) {
  const TempDir dir;
  EXPECT_THAT([&] { (void)ExrFile(dir.path()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("cannot read: is a directory")));
  ASSERT_EQ(::system(("mkfifo " + (dir / "pipe.exr").string()).c_str()), 0);
  EXPECT_THAT(
      [&] { (void)ExrFile(dir / "pipe.exr"); },
      ThrowsMessage<std::runtime_error>(HasSubstr("pipe.exr: cannot read: not a regular file")));
}

TEST(ExrFile, TruncatedPixelsAreAnError) {
  const TempDir dir;
  Plane<float> plane({64, 64});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) plane(x, y) = std::sin(static_cast<float>(x * 64 + y));
  }
  const ExrChannel channels[] = {{"Z", ExrType::kFloat, &plane}};
  write_exr(dir / "a.exr", channels, {});
  const std::string bytes = read_whole_file(dir / "a.exr");
  write_file_atomically(dir / "short.exr", bytes.substr(0, bytes.size() / 2));
  const ExrFile file(dir / "short.exr");
  EXPECT_THAT([&] { (void)file.read(std::array{0}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("short.exr: cannot read pixels: ")));
  EXPECT_THAT([&] { rewrite_exr(file, dir / "out.exr", {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("short.exr: cannot copy: ")));
  EXPECT_FALSE(std::filesystem::exists(dir / "out.exr"));
}

}  // namespace
}  // namespace eigenlight
