// A frame as its files have it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frame/plane.h"
#include "sequences/denoise/file_headers.h"
#include "sequences/denoise/sequence_files.h"
#include "sequences/exr/exr_file.h"
#include "sequences/layers/layer_plan.h"

namespace eigenlight {

/// The channels of a layer on the canvas; absent pixels are 0.
using LayerPlanes = std::vector<Plane<float>>;

/// The layers of one frame that a plan reads.
class RawFrame {
 public:
  int frame = 0;
  std::vector<std::shared_ptr<const ExrFile>> files;  ///< one for each input

  /// Throws std::logic_error if the plan does not read that layer.
  [[nodiscard]] const LayerPlanes& at(const FileLayer& layer) const;
  [[nodiscard]] const Plane<std::uint32_t>& id(const std::string& view) const {
    return ids.at(view);
  }

  std::map<std::string, LayerPlanes> planes;        ///< by key_of()
  std::map<std::string, Plane<std::uint32_t>> ids;  ///< by view
  /// Where the file has pixels of light: its data window on the canvas, by view.
  std::map<std::string, ExrWindow> present;
};

/// Views of the first three channels of a layer, or of one that is gray; valid as long as it is.
[[nodiscard]] Planes<3> view_layer(const LayerPlanes& layer);

/// A name that no other layer of the inputs has.
[[nodiscard]] std::string key_of(const FileLayer& layer);

/// Reads the layers of `plan` and places them on the canvas. Throws BadFile naming file and layer
/// if a layer is missing or has fewer channels than in the first frame; std::runtime_error if a
/// file cannot be read.
[[nodiscard]] RawFrame read_raw_frame(const FrameFiles& paths, const LayerPlan& plan,
                                      const ExrWindow& canvas);

/// Index of a layer's channels in a file. Throws BadFile naming file and channel if one is missing.
[[nodiscard]] std::vector<int> channel_indices(const ExrFile& file, const std::string& path,
                                               const FileLayer& layer);

}  // namespace eigenlight
