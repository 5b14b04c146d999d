#include "sequences/files/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <string>

#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::size_t files_in(const std::filesystem::path& dir) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(dir)) ++count;
  return count;
}

// While it lives, no file of this process can grow beyond `bytes`, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  void (*handler_)(int);
};

TEST(AtomicFile, ReplacesAFileAndLeavesNoTemporary) {
  const TempDir dir;
  write_file_atomically(dir / "a", "first");
  write_file_atomically(dir / "a", "second");
  EXPECT_EQ(read_whole_file(dir / "a"), "second");
  EXPECT_EQ(files_in(dir.path()), 1u);
}

TEST(AtomicFile, FailedWriteKeepsTheOldFileAndLeavesNoTemporary) {
  const TempDir dir;
  write_file_atomically(dir / "a", "old");
  const std::string large(1 << 16, 'x');
  {
    const FileSizeLimit limit(1000);
    EXPECT_THAT([&] { write_file_atomically(dir / "a", large); },
                ThrowsMessage<std::runtime_error>(HasSubstr("a: cannot write: File too large")));
  }
  EXPECT_EQ(read_whole_file(dir / "a"), "old");
  EXPECT_EQ(files_in(dir.path()), 1u);
}

TEST(AtomicFile, ErrorsNamePathAndReason) {
  const TempDir dir;
  EXPECT_THAT([&] { write_file_atomically(dir / "no/a", "x"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no/a: cannot write: No such file")));
  std::filesystem::create_directory(dir / "sub");
  EXPECT_THAT([&] { write_file_atomically(dir / "sub", "x"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("sub: cannot write: Is a directory")));
  EXPECT_EQ(files_in(dir.path()), 1u);
  EXPECT_THAT([&] { (void)read_whole_file(dir / "none"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none: cannot read: No such file")));
  EXPECT_THAT([&] { (void)read_whole_file(dir / "sub"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("sub: cannot read: is a directory")));
}

}  // namespace
}  // namespace eigenlight
