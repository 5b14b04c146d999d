// The layers of EXR files: channels that belong together.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/exr/exr_file.h"

namespace eigenlight {

/// Channels that belong together: `albedo.R`, `albedo.G` and `albedo.B` are the layer `albedo`.
struct FileLayer {
  /// As the file has it, behind the part's name where channels do not repeat that; without the
  /// view. Empty: bare `R`, `G`, `B` of the only part.
  std::string name;
  std::string view;               ///< of a stereo file, or empty
  int input = 0;                  ///< which input of the command
  int part = 0;                   ///< of the first channel
  ExrType type = ExrType::kHalf;  ///< of the first channel; kUint if any holds integers
  bool is_deep = false, is_subsampled = false;
  /// Full channel names, in the order R G B A, X Y Z W or u v; one name for a layer of one channel.
  std::vector<std::string> channels;

  [[nodiscard]] std::size_t size() const { return channels.size(); }
};

/// Name for messages: the view in front, and `color` for bare R, G, B.
[[nodiscard]] std::string name_for_people(const FileLayer& layer);

/// The layers of a file in the order of their first channels. Channels of one layer may lie in
/// several parts. `R`, `r` and `red` are one, as are G, B, A, X, Y, Z, W and U, V. In a layer with
/// R, G, B a channel Z, or one of any other name, is a layer of its own.
[[nodiscard]] std::vector<FileLayer> list_layers(const std::vector<ExrChannelInfo>& channels,
                                                 const std::vector<ExrPart>& parts, int input);
[[nodiscard]] inline std::vector<FileLayer> list_layers(const ExrFile& file, int input) {
  return list_layers(file.channels(), file.parts(), input);
}

}  // namespace eigenlight
