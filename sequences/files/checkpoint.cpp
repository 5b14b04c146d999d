#include "sequences/files/checkpoint.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <bit>
#include <cstring>
#include <memory>
#include <string_view>

#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as it is in memory");

constexpr std::string_view kMagic = "ELSTATE\n";
constexpr std::uint32_t kVersion = 1;

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t padding;
  std::uint64_t position, run_size, state_size, checksum;
};
static_assert(sizeof(Header) == 48 && std::has_unique_object_representations_v<Header>);

std::uint64_t checksum_of(Header header, std::string_view body) {
  header.checksum = 0;
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> hash(XXH3_createState(),
                                                                      XXH3_freeState);
  XXH3_64bits_reset(hash.get());
  XXH3_64bits_update(hash.get(), &header, sizeof(header));
  XXH3_64bits_update(hash.get(), body.data(), body.size());
  return XXH3_64bits_digest(hash.get());
}

[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view why) {
  throw CheckpointError(fmt::format("{}: {}", path.string(), why));
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  Header header = {};
  std::memcpy(header.magic, kMagic.data(), sizeof(header.magic));
  header.version = kVersion;
  header.position = checkpoint.position;
  header.run_size = checkpoint.run.size();
  header.state_size = checkpoint.state.size();
  std::vector<char> bytes(sizeof(header) + checkpoint.run.size() + checkpoint.state.size());
  char* body = bytes.data() + sizeof(header);
  std::memcpy(body, checkpoint.run.data(), checkpoint.run.size());
  if (!checkpoint.state.empty()) {
    std::memcpy(body + checkpoint.run.size(), checkpoint.state.data(), checkpoint.state.size());
  }
  header.checksum = checksum_of(header, {body, bytes.size() - sizeof(header)});
  std::memcpy(bytes.data(), &header, sizeof(header));
  write_file_atomically(path, {bytes.data(), bytes.size()});
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  const std::string bytes = read_whole_file(path);
  Header header = {};
  if (bytes.size() < sizeof(header) || !bytes.starts_with(kMagic)) {
    refuse(path, "not a checkpoint, or truncated");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.version != kVersion) {
    refuse(path, fmt::format("a checkpoint of format version {}; this program reads version {}",
                             header.version, kVersion));
  }
  const std::string_view body = std::string_view(bytes).substr(sizeof(header));
  // A sum of damaged sizes could overflow; these comparisons cannot.
  if (header.run_size > body.size() || header.state_size != body.size() - header.run_size) {
    refuse(path, fmt::format("truncated or damaged: {} bytes follow the header, {} + {} expected",
                             body.size(), header.run_size, header.state_size));
  }
  if (checksum_of(header, body) != header.checksum) {
    refuse(path, "damaged: the checksum does not match");
  }
  Checkpoint checkpoint;
  checkpoint.run = body.substr(0, header.run_size);
  checkpoint.position = header.position;
  checkpoint.state.assign(body.begin() + static_cast<std::ptrdiff_t>(header.run_size), body.end());
  return checkpoint;
}

void restore_state(const std::filesystem::path& path, const Checkpoint& checkpoint,
                   const std::function<void(StateReader&)>& load) {
  try {
    StateReader reader({checkpoint.state.data(), checkpoint.state.size()});
    load(reader);
    reader.finish();
  } catch (const std::runtime_error& error) {
    throw CheckpointError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

void check_complete(const std::filesystem::path& path, int frame,
                    std::span<const std::filesystem::path> files) {
  for (const std::filesystem::path& file : files) {
    if (std::filesystem::exists(file)) continue;
    throw CheckpointError(fmt::format("{}: counts frame {} as complete, but {} is missing",
                                      path.string(), frame, file.string()));
  }
}

}  // namespace eigenlight
