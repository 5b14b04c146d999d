// Copies of OpenEXR files in which some channels have new pixels and nothing else changes.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "frame/plane.h"
#include "sequences/exr/exr_file.h"

namespace eigenlight {

struct ExrReplacement {
  int channel = 0;                       ///< index into ExrFile::channels()
  const Plane<float>* pixels = nullptr;  ///< extent of the data window of its part
};

struct ExrRewriteReport {
  ExrOverflow values;  ///< among the new pixels
  /// Parts whose compression loses precision: "part 'x': DWAA becomes ZIP"; without the name of the
  /// part in files of one part.
  std::vector<std::string> recompressed;
  /// Mip and rip maps: "part 'x': smaller levels of the new channels are averages of them".
  std::vector<std::string> levels;
};

/// Writes `in` to `out` with new pixels in some channels.
///
/// All headers are the same byte for byte, apart from the compression of a part in `recompressed`
/// and its number of chunks. A part without a new channel (deep ones too) is copied byte for byte.
/// A part with one is encoded again, with its compression, order of lines and tiles; its other
/// channels keep their bits, NaN included. Lossy compressions (DWA; B44 of half; PXR24 of float)
/// become ZIP. Smaller levels of mip and rip maps are made of the new pixels by averaging over
/// their area; other channels keep theirs.
///
/// Written completely or not at all (atomic_file.h); `out` may be the file of `in`. Throws BadFile
/// if a channel to replace is deep, subsampled or of integers, std::invalid_argument on pixels of
/// another size or a channel named twice, std::runtime_error naming the file that cannot be read
/// or written.
ExrRewriteReport rewrite_exr(const ExrFile& in, const std::filesystem::path& out,
                             std::span<const ExrReplacement> replacements);

}  // namespace eigenlight
