// Chunks: the blocks of lines or tiles that an OpenEXR file consists of, and the table that says
// where they are. As in the document "OpenEXR File Layout".
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <cstdint>
#include <vector>

namespace eigenlight {

/// A level of a mip map or rip map; level (0, 0) is the picture.
struct ExrLevel {
  int lx = 0, ly = 0;
  int width = 0, height = 0;
  int columns = 0, rows = 0;  ///< tiles; of a part without tiles one column of chunks
  std::int64_t first = 0;     ///< place of its first chunk in the table
};

/// The order of the chunks of a part in its table.
class ExrChunkGrid {
 public:
  /// Of a header that OpenEXR accepted, with another compression.
  ExrChunkGrid(const Imf::Header& header, Imf::Compression compression);

  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] const std::vector<ExrLevel>& levels() const { return levels_; }
  [[nodiscard]] int lines() const { return lines_; }  ///< of one chunk
  [[nodiscard]] bool is_tiled() const { return is_tiled_; }
  [[nodiscard]] bool is_deep() const { return is_deep_; }
  /// Bytes before the data of a chunk, without the number of the part.
  [[nodiscard]] std::size_t head_bytes() const;
  /// Place in the table of the chunk that starts with `head`. -1 if there is none.
  [[nodiscard]] std::int64_t index_of(const std::vector<unsigned char>& head) const;
  /// Bytes of data behind the head, -1 if they are negative.
  [[nodiscard]] std::int64_t data_bytes(const std::vector<unsigned char>& head) const;

 private:
  std::vector<ExrLevel> levels_;
  std::int64_t count_ = 0;
  int lines_ = 1, first_line_ = 0;
  bool is_tiled_ = false, is_deep_ = false;
};

}  // namespace eigenlight
