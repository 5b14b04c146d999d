// OpenEXR files as the C core of OpenEXR reads them: every attribute and every value as bytes, for
// comparing files independently of sequences/exr/, which uses the C++ library.
#pragma once

#include <OpenEXR/openexr.h>
#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sequences/files/atomic_file.h"

namespace eigenlight {

struct CorePart {
  std::vector<std::pair<std::string, std::string>> attributes;  ///< "name type", value
  std::map<std::string, std::string> values;  ///< of "channel lx ly": the bytes of its pixels
  std::vector<std::string> chunks;  ///< as they are in the file, in the order of the table
};

struct CoreFile {
  std::uint32_t version = 0;
  std::vector<CorePart> parts;
};

/// Reads one file. Throws std::runtime_error where the core refuses it.
class CoreReader {
 public:
  static CoreFile read(const std::string& path) {
    CoreFile file;
    read_headers(read_whole_file(path), file);
    CoreReader reader(path);
    for (int part = 0; part < static_cast<int>(file.parts.size()); ++part) {
      reader.read_part(part, file.parts[static_cast<std::size_t>(part)]);
    }
    return file;
  }

 private:
  explicit CoreReader(const std::string& path) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
    check(exr_start_read(&context_, path.c_str(), &options));
  }
  CoreReader(const CoreReader&) = delete;
  CoreReader& operator=(const CoreReader&) = delete;
  ~CoreReader() { exr_finish(&context_); }

  static void check(exr_result_t result) {
    if (result == EXR_ERR_SUCCESS) return;
    throw std::runtime_error(exr_get_default_error_message(result));
  }

  // Header bytes without any library.
  static void read_headers(const std::string& bytes, CoreFile& file) {
    std::memcpy(&file.version, bytes.data() + 4, 4);
    std::size_t at = 8;
    const auto word = [&] {
      const std::string text = bytes.c_str() + at;
      at += text.size() + 1;
      return text;
    };
    do {
      CorePart part;
      for (std::string name = word(); !name.empty(); name = word()) {
        name = fmt::format("{} {}", name, word());
        std::int32_t size = 0;
        std::memcpy(&size, bytes.data() + at, 4);
        part.attributes.emplace_back(name, bytes.substr(at + 4, static_cast<std::size_t>(size)));
        at += 4 + static_cast<std::size_t>(size);
      }
      if (part.attributes.empty()) return;
      file.parts.push_back(std::move(part));
    } while (file.version & 0x1000U);
  }

  void read_part(int part, CorePart& out) {
    exr_storage_t storage{};
    check(exr_get_storage(context_, part, &storage));
    exr_attr_box2i_t window{};
    check(exr_get_data_window(context_, part, &window));
    exr_chunk_info_t chunk{};
    if (storage == EXR_STORAGE_SCANLINE || storage == EXR_STORAGE_DEEP_SCANLINE) {
      std::int32_t lines = 0;
      check(exr_get_scanlines_per_chunk(context_, part, &lines));
      for (int y = window.min.y; y <= window.max.y; y += lines) {
        check(exr_read_scanline_chunk_info(context_, part, y, &chunk));
        read_chunk(part, chunk, storage == EXR_STORAGE_DEEP_SCANLINE, out);
      }
      return;
    }
    for_each_tile(part, [&](int x, int y, int lx, int ly) {
      check(exr_read_tile_chunk_info(context_, part, x, y, lx, ly, &chunk));
      read_chunk(part, chunk, storage == EXR_STORAGE_DEEP_TILED, out);
    });
  }

  template <typename Body>
  void for_each_tile(int part, const Body& body) {
    std::uint32_t width = 0, height = 0;
    exr_tile_level_mode_t mode{};
    exr_tile_round_mode_t rounding{};
    check(exr_get_tile_descriptor(context_, part, &width, &height, &mode, &rounding));
    std::int32_t across = 0, down = 0;
    check(exr_get_tile_levels(context_, part, &across, &down));
    for (int ly = 0; ly < down; ++ly) {
      for (int lx = 0; lx < across; ++lx) {
        if (mode != EXR_TILE_RIPMAP_LEVELS && lx != ly) continue;
        std::int32_t w = 0, h = 0;
        check(exr_get_level_sizes(context_, part, lx, ly, &w, &h));
        for (int y = 0; y * static_cast<int>(height) < h; ++y) {
          for (int x = 0; x * static_cast<int>(width) < w; ++x) body(x, y, lx, ly);
        }
      }
    }
  }

  void read_chunk(int part, const exr_chunk_info_t& chunk, bool is_deep, CorePart& out) {
    std::string packed(chunk.packed_size, '\0');
    if (is_deep) {
      std::string table(chunk.sample_count_table_size, '\0');
      check(exr_read_deep_chunk(context_, part, &chunk, packed.data(), table.data()));
      out.chunks.push_back(table + packed);
      return;
    }
    check(exr_read_chunk(context_, part, &chunk, packed.data()));
    out.chunks.push_back(std::move(packed));
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    check(exr_decoding_initialize(context_, part, &chunk, &pipeline));
    std::vector<std::string> values(static_cast<std::size_t>(pipeline.channel_count));
    for (std::size_t c = 0; c < values.size(); ++c) {
      exr_coding_channel_info_t& channel = pipeline.channels[c];
      const int line = channel.width * channel.bytes_per_element;
      values[c].resize(static_cast<std::size_t>(line) * static_cast<std::size_t>(channel.height) +
                       1);
      channel.user_pixel_stride = channel.bytes_per_element;
      channel.user_line_stride = line;
      channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(values[c].data());
    }
    exr_result_t result = exr_decoding_choose_default_routines(context_, part, &pipeline);
    if (result == EXR_ERR_SUCCESS) result = exr_decoding_run(context_, part, &pipeline);
    for (std::size_t c = 0; c < values.size(); ++c) {
      values[c].pop_back();
      out.values[fmt::format("{} {} {}", pipeline.channels[c].channel_name, chunk.level_x,
                             chunk.level_y)] += values[c];
    }
    exr_decoding_destroy(context_, &pipeline);
    check(result);
  }

  exr_context_t context_ = nullptr;
};

/// Whether `replaced` holds "PART CHANNEL"; `channel` has its levels behind it.
inline bool is_replaced(const std::vector<std::string>& replaced, std::size_t part,
                        const std::string& channel) {
  for (const std::string& name : replaced) {
    const std::size_t space = name.find(' ');
    if (name.substr(0, space) == fmt::format("{}", part) &&
        channel.starts_with(fmt::format("{} ", name.substr(space + 1)))) {
      return true;
    }
  }
  return false;
}

/// What differs between two files, one difference a line; nothing if they are equal but for the
/// pixels of the channels named in `replaced`, "PART CHANNEL". Parts without such a channel must
/// have equal chunks, others equal values, whatever the compression.
inline std::vector<std::string> differences(const CoreFile& a, const CoreFile& b,
                                            const std::vector<std::string>& replaced) {
  std::vector<std::string> found;
  const auto note = [&](std::size_t part, const std::string& what) {
    found.push_back(fmt::format("part {}: {}", part, what));
  };
  if (a.version != b.version) found.push_back("version");
  if (a.parts.size() != b.parts.size()) return {"number of parts"};
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    const CorePart &one = a.parts[i], &two = b.parts[i];
    bool is_new = false;
    for (const auto& [channel, values] : one.values) is_new |= is_replaced(replaced, i, channel);
    if (!is_new && one.chunks != two.chunks) note(i, "chunks");
    if (one.values.size() != two.values.size()) note(i, "number of channels");
    for (const auto& [channel, values] : one.values) {
      const auto other = two.values.find(channel);
      if (other == two.values.end()) {
        note(i, "no channel " + channel);
      } else if (!is_replaced(replaced, i, channel) && other->second != values) {
        note(i, "values of " + channel);
      }
    }
    if (one.attributes.size() != two.attributes.size()) {
      note(i, "number of attributes");
      continue;
    }
    for (std::size_t k = 0; k < one.attributes.size(); ++k) {
      const std::string& name = one.attributes[k].first;
      if (is_new && (name == "compression compression" || name == "chunkCount int")) continue;
      if (one.attributes[k] != two.attributes[k]) note(i, "attribute " + name);
    }
  }
  return found;
}

}  // namespace eigenlight
