#include "sequences/exr/exr_complete.h"

#include <algorithm>

#include "sequences/exr/exr_chunks.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

// Whether all chunks of a part end within the file.
bool is_complete(const ExrFile& file, int part) {
  const ExrFile::State& in = file.state();
  const Imf::Header& header = in.file->header(part);
  const ExrChunkGrid grid(header, header.compression());
  const std::size_t number_bytes = in.raw.is_multipart() ? 4 : 0;
  std::vector<unsigned char> head(grid.head_bytes());
  const std::vector<std::uint64_t> places = chunk_places(in, part);
  return std::all_of(places.begin(), places.end(), [&](std::uint64_t place) {
    if (place < in.raw.end || place + number_bytes + head.size() > file.bytes()) return false;
    in.bytes->read_at(place + number_bytes, head.data(), head.size());
    const std::int64_t data = grid.data_bytes(head);
    const std::uint64_t left = file.bytes() - place - number_bytes - head.size();
    return data >= 0 && static_cast<std::uint64_t>(data) <= left;
  });
}

}  // namespace

std::vector<std::uint64_t> chunk_places(const ExrFile::State& file, int part) {
  const auto count_of = [&](int i) {
    const Imf::Header& header = file.file->header(i);
    return static_cast<std::size_t>(ExrChunkGrid(header, header.compression()).count());
  };
  std::uint64_t table = file.raw.end;
  for (int i = 0; i < part; ++i) table += count_of(i) * 8;
  std::vector<unsigned char> bytes(count_of(part) * 8);
  file.bytes->read_at(table, bytes.data(), bytes.size());
  std::vector<std::uint64_t> places(bytes.size() / 8, 0);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    places[i / 8] |= static_cast<std::uint64_t>(bytes[i]) << (8 * (i % 8));
  }
  std::sort(places.begin(), places.end());
  return places;
}

bool is_complete_exr(const std::filesystem::path& path) noexcept {
  try {
    const ExrFile file(path);
    for (std::size_t part = 0; part < file.parts().size(); ++part) {
      if (!is_complete(file, static_cast<int>(part))) return false;
    }
    return true;
  } catch (...) {
    return false;
  }
}

}  // namespace eigenlight
