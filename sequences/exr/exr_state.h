// What an ExrFile holds, for the sources of this folder.
#pragma once

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPixelType.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "sequences/exr/exr_file.h"
#include "sequences/exr/exr_header.h"
#include "sequences/exr/exr_stream.h"

namespace eigenlight {

struct ExrFile::State {
  std::filesystem::path path;
  std::unique_ptr<ExrInput> bytes;
  ExrRawHeader raw;
  std::unique_ptr<Imf::MultiPartInputFile> file;
  ExrWindow display;
  std::vector<ExrPart> parts;
  std::vector<ExrChannelInfo> channels;
  std::mutex decoding;

  [[nodiscard]] const ExrPart& part_of(const ExrChannelInfo& channel) const {
    return parts[static_cast<std::size_t>(channel.part)];
  }
  /// "part 'x': " in files of several parts, else nothing.
  [[nodiscard]] std::string in_part(int part) const;
  /// Throws BadFile unless a part's pixels can be that many in a file of this size.
  void check_size(int part) const;
};

[[nodiscard]] Imf::PixelType pixel_type(ExrType type);
[[nodiscard]] std::size_t bytes_of(ExrType type);
/// Channels of one part, by their place in the header, described without pixels.
[[nodiscard]] std::vector<ExrChannelInfo> describe_channels(const Imf::Header& header, int part,
                                                            bool is_multipart);
[[nodiscard]] ExrPart describe_part(const Imf::Header& header);
/// Where the chunks of a part are, in the order of the file; 0 for a chunk that was never written.
[[nodiscard]] std::vector<std::uint64_t> chunk_places(const ExrFile::State& file, int part);
/// Lines of one chunk of a part that is not tiled.
[[nodiscard]] int lines_of_chunk(Imf::Compression compression);

}  // namespace eigenlight
