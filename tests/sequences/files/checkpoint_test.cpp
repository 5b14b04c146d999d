#include "sequences/files/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sequences/files/atomic_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

Checkpoint example() {
  Checkpoint checkpoint{R"({"scene":"atrium"})", 12, {}};
  for (int i = 0; i < 1000; ++i) checkpoint.state.push_back(static_cast<char>(i * 7));
  return checkpoint;
}

TEST(Checkpoint, ReadsWhatWasWritten) {
  const TempDir dir;
  for (Checkpoint checkpoint : {example(), Checkpoint{}}) {
    write_checkpoint(dir / "state.bin", checkpoint);
    const Checkpoint read = read_checkpoint(dir / "state.bin");
    EXPECT_EQ(read.run, checkpoint.run);
    EXPECT_EQ(read.position, checkpoint.position);
    EXPECT_EQ(read.state, checkpoint.state);
  }
}

TEST(Checkpoint, FlippedBitInAnyByteIsAnError) {
  const TempDir dir;
  write_checkpoint(dir / "state.bin", example());
  const std::string bytes = read_whole_file(dir / "state.bin");
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    write_file_atomically(dir / "damaged.bin", damaged);
    EXPECT_THROW((void)read_checkpoint(dir / "damaged.bin"), CheckpointError) << "byte " << i;
  }
}

TEST(Checkpoint, WrongLengthIsAnError) {
  const TempDir dir;
  write_checkpoint(dir / "state.bin", example());
  const std::string bytes = read_whole_file(dir / "state.bin");
  for (std::size_t size = 0; size < bytes.size(); size += 13) {
    write_file_atomically(dir / "short.bin", bytes.substr(0, size));
    EXPECT_THAT([&] { (void)read_checkpoint(dir / "short.bin"); },
                ThrowsMessage<CheckpointError>(HasSubstr("truncated")));
  }
  write_file_atomically(dir / "long.bin", bytes + "x");
  EXPECT_THROW((void)read_checkpoint(dir / "long.bin"), CheckpointError);
}

TEST(Checkpoint, ErrorsNameTheFault) {
  const TempDir dir;
  EXPECT_THAT([&] { (void)read_checkpoint(dir / "none.bin"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.bin: cannot read")));
  write_checkpoint(dir / "state.bin", example());
  std::string bytes = read_whole_file(dir / "state.bin");
  bytes[8] = 99;
  write_file_atomically(dir / "other.bin", bytes);
  EXPECT_THAT([&] { (void)read_checkpoint(dir / "other.bin"); },
              ThrowsMessage<CheckpointError>(HasSubstr("format version 99; this program reads")));
}

}  // namespace
}  // namespace eigenlight
