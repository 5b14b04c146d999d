// Sequences of files of which one layer is looked at.
#pragma once

#include <filesystem>
#include <string>

#include "frame/plane.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/sequence_name.h"

namespace eigenlight {

/// A sequence of files, and what names of its layers begin with: `ref.####.exr:HalfA` are the
/// layers `HalfA.*`.
struct LayerSequence {
  SequenceName name;
  std::string prefix;  ///< or empty
};

/// The name of a file that exists is that file, whatever signs it holds. Throws
/// std::invalid_argument as SequenceName does.
[[nodiscard]] LayerSequence parse_layer_sequence(const std::string& text);

/// The name by which a file has the layer `asked` behind `prefix`; as ExrReader finds names of
/// other renderers.
[[nodiscard]] std::string prefixed_layer(const ExrReader& reader, const std::string& asked,
                                         const std::string& prefix);

/// R, G, B of a layer of one frame. Throws as ExrReader does.
[[nodiscard]] Planes<3> read_layer(const LayerSequence& sequence, int frame,
                                   const std::string& layer);

}  // namespace eigenlight
