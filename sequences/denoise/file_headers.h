// The headers of all files of a sequence, each read once.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sequences/denoise/sequence_files.h"
#include "sequences/exr/exr_file.h"
#include "sequences/layers/layer_plan.h"

namespace eigenlight {

/// What a plan needs to know of a file without its pixels.
struct FileHeader {
  std::filesystem::path path;
  ExrWindow display;
  std::vector<ExrPart> parts;
  std::vector<ExrChannelInfo> channels;
  std::optional<ExrChromaticities> chromaticities;  ///< none: those of Rec. 709
};

/// The files of one frame, in the order of the inputs.
using FrameHeaders = std::vector<FileHeader>;

/// All layers of floats that a view reads.
[[nodiscard]] std::vector<const FileLayer*> layers_read(const ViewPlan& view);
/// The first layer of light that stands in a file: its pixels are those of the picture.
[[nodiscard]] const FileLayer& first_light(const ViewPlan& view);

/// Throws what ExrFile throws.
[[nodiscard]] std::vector<FrameHeaders> read_headers(const std::vector<FrameFiles>& frames);

/// Index of a layer's channels in a file. Throws BadFile naming file and channel if one is missing.
[[nodiscard]] std::vector<int> channel_indices(const std::vector<ExrChannelInfo>& channels,
                                               const std::string& path, const FileLayer& layer);

/// The smallest window that holds all pixels of light of all frames, in display coordinates. Throws
/// BadFile naming the first file that lacks a light of the plan, or whose display window is not as
/// large as that of the first.
[[nodiscard]] ExrWindow find_canvas(const std::vector<FrameHeaders>& headers,
                                    const LayerPlan& plan);

/// Throws BadFile naming the first file that lacks a channel of a layer that the plan reads: before
/// the first frame is denoised, not when its turn comes.
void check_layers(const std::vector<FrameHeaders>& headers, const LayerPlan& plan);

/// A line on files whose colors have other primaries than those of the first; empty if none has.
[[nodiscard]] std::string other_primaries(const std::vector<FrameHeaders>& headers);

}  // namespace eigenlight
