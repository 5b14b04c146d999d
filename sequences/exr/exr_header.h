// Where things stand in the header of an OpenEXR file, to copy it byte for byte.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/exr/exr_stream.h"

namespace eigenlight {

struct ExrRawAttribute {
  std::string name, type;
  std::uint64_t position = 0;  ///< of the value in the file
  std::int32_t size = 0;
};

struct ExrRawHeader {
  std::uint32_t version = 0;                        ///< with flags
  std::vector<std::vector<ExrRawAttribute>> parts;  ///< attributes in the order of the file
  std::uint64_t end = 0;                            ///< where the tables of chunks start

  [[nodiscard]] bool is_multipart() const { return (version & 0x1000U) != 0; }
};

/// Before anything large is allocated, throws BadFile if the file is of another kind or of another
/// version of OpenEXR, and Iex::InputExc if it ends within the header, starts with zeros, or lacks
/// an attribute that pixels need: a file that is still being written may become whole.
[[nodiscard]] ExrRawHeader scan_exr_header(ExrInput& file);

}  // namespace eigenlight
