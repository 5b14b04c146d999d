#include "sequences/exr/exr_chunks.h"

#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>

#include <algorithm>

#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

int level_count(std::int64_t side, Imf::LevelRoundingMode mode) {
  int levels = 1;
  for (std::int64_t n = side; n > 1; ++levels) n = mode == Imf::ROUND_UP ? (n + 1) / 2 : n / 2;
  return levels;
}

int level_side(std::int64_t side, int level, Imf::LevelRoundingMode mode) {
  const std::int64_t scale = std::int64_t{1} << level;
  const std::int64_t n = mode == Imf::ROUND_UP ? (side + scale - 1) / scale : side / scale;
  return static_cast<int>(std::max<std::int64_t>(n, 1));
}

std::int64_t read_int(const std::vector<unsigned char>& bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{bytes[at + i]} << (8 * i);
  if (size == 4) return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
  return static_cast<std::int64_t>(value);
}

std::vector<ExrLevel> make_levels(const Imf::TileDescription& tiles, int width, int height) {
  const bool rip = tiles.mode == Imf::RIPMAP_LEVELS;
  int across = 1, down = 1;
  if (tiles.mode == Imf::MIPMAP_LEVELS) {
    across = level_count(std::max(width, height), tiles.roundingMode);
  } else if (rip) {
    across = level_count(width, tiles.roundingMode);
    down = level_count(height, tiles.roundingMode);
  }
  std::vector<ExrLevel> levels;
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      ExrLevel level{x, rip ? y : x, 0, 0, 0, 0, 0};
      level.width = level_side(width, level.lx, tiles.roundingMode);
      level.height = level_side(height, level.ly, tiles.roundingMode);
      level.columns = (level.width - 1) / static_cast<int>(tiles.xSize) + 1;
      level.rows = (level.height - 1) / static_cast<int>(tiles.ySize) + 1;
      levels.push_back(level);
    }
  }
  return levels;
}

}  // namespace

int lines_of_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 1;
  }
}

ExrChunkGrid::ExrChunkGrid(const Imf::Header& header, Imf::Compression compression) {
  const Imath::Box2i& window = header.dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  const std::string type = header.hasType() ? header.type() : Imf::SCANLINEIMAGE;
  is_tiled_ = Imf::isTiled(type);
  is_deep_ = Imf::isDeepData(type);
  first_line_ = window.min.y;
  if (is_tiled_) {
    lines_ = static_cast<int>(header.tileDescription().ySize);
    levels_ = make_levels(header.tileDescription(), width, height);
  } else {
    lines_ = lines_of_chunk(compression);
    levels_ = {{0, 0, width, height, 1, (height - 1) / lines_ + 1, 0}};
  }
  for (ExrLevel& level : levels_) {
    level.first = count_;
    count_ += std::int64_t{level.columns} * level.rows;
  }
}

std::size_t ExrChunkGrid::head_bytes() const {
  return (is_tiled_ ? 16U : 4U) + (is_deep_ ? 24U : 4U);
}

std::int64_t ExrChunkGrid::index_of(const std::vector<unsigned char>& head) const {
  if (!is_tiled_) {
    const std::int64_t line = read_int(head, 0, 4) - first_line_;
    if (line < 0 || line % lines_ != 0 || line / lines_ >= count_) return -1;
    return line / lines_;
  }
  const std::int64_t x = read_int(head, 0, 4), y = read_int(head, 4, 4);
  const std::int64_t lx = read_int(head, 8, 4), ly = read_int(head, 12, 4);
  for (const ExrLevel& level : levels_) {
    if (level.lx != lx || level.ly != ly) continue;
    if (x < 0 || y < 0 || x >= level.columns || y >= level.rows) return -1;
    return level.first + y * level.columns + x;
  }
  return -1;
}

std::int64_t ExrChunkGrid::data_bytes(const std::vector<unsigned char>& head) const {
  const std::size_t at = is_tiled_ ? 16 : 4;
  if (!is_deep_) return read_int(head, at, 4);
  const std::int64_t table = read_int(head, at, 8), data = read_int(head, at + 8, 8);
  if (table < 0 || data < 0 || table > INT64_MAX - data) return -1;
  return table + data;
}

}  // namespace eigenlight
