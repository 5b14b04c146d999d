// An OpenEXR file being written chunk by chunk.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "sequences/exr/exr_chunks.h"
#include "sequences/files/atomic_file.h"

namespace eigenlight {

/// Header, tables of chunks, chunks. Not there until finish().
class ExrOutput {
 public:
  /// Writes the header and leaves room for the tables of `grids`. Throws std::runtime_error naming
  /// the file, here and below.
  ExrOutput(const std::filesystem::path& path, std::string_view header,
            std::vector<ExrChunkGrid> grids, bool is_multipart);

  [[nodiscard]] const ExrChunkGrid& grid(int part) const {
    return grids_[static_cast<std::size_t>(part)];
  }
  /// Starts a chunk: its head without the number of the part. Throws Iex::InputExc unless the head
  /// is that of a chunk of the part, and the first with this place.
  void start_chunk(int part, const std::vector<unsigned char>& head);
  void write(std::string_view bytes);
  /// Throws Iex::InputExc if a chunk is missing.
  void finish();

 private:
  void flush();

  AtomicFile file_;
  std::vector<ExrChunkGrid> grids_;
  std::vector<std::vector<std::uint64_t>> tables_;
  bool is_multipart_;
  std::uint64_t tables_start_, position_;
  std::vector<char> buffer_;
};

/// What an encoder of OpenEXR writes, of which the chunks go into one part of an ExrOutput; header
/// and table are dropped.
class ExrChunkSink : public Imf::OStream {
 public:
  ExrChunkSink(ExrOutput& output, int part);

  /// While this lives, the encoder writes chunks. To be made after the encoder.
  class Open {
   public:
    explicit Open(ExrChunkSink& sink) : sink_(sink) { sink_.is_open_ = true; }
    ~Open() { sink_.is_open_ = false; }
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;

   private:
    ExrChunkSink& sink_;
  };

  void write(const char from[], int count) override;
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

 private:
  ExrOutput& output_;
  int part_;
  bool is_open_ = false;
  std::uint64_t position_ = 0;
  std::vector<unsigned char> head_;
  std::int64_t data_left_ = 0;
};

}  // namespace eigenlight
