// Reading and writing OpenEXR files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "frame/plane.h"
#include "sequences/exr/exr_write.h"

namespace eigenlight {

/// Writes one picture of 32-bit floats, whose channels are the letters of `axes`: `RGB`, `XYZ`.
inline void write_float_layer(const std::filesystem::path& path, std::string_view axes,
                              const Planes<3>& planes) {
  std::vector<ExrChannel> channels;
  for (std::size_t c = 0; c < 3; ++c) {
    channels.push_back({std::string(1, axes.at(c)), ExrType::kFloat, &planes[c]});
  }
  write_exr(path, channels, {});
}

/// Reads layers of any OpenEXR file: scanlines or tiles, one part or many. The layer of a channel
/// is its name up to the last dot: `albedo.R` belongs to `albedo`. Bare `R`, `G`, `B`, `A` belong
/// to the layer "", other bare names (`Z`, `id`) are layers of their own. From the second part on
/// the part's name comes first, unless the channel names repeat it.
///
/// In files of other renderers our layer names `color`, `albedo`, `N`, `Z`, `P`, `motion`,
/// `direct`, `indirect` find the layers of Cycles, Arnold, RenderMan and pbrt with that meaning
/// (exr_layers.h). Only names are translated: units, axes and signs stay those of the file.
class ExrReader {
 public:
  /// Opens `path` and reads its headers. Throws std::runtime_error naming the file.
  explicit ExrReader(const std::filesystem::path& path);
  ~ExrReader();
  ExrReader(ExrReader&&) noexcept;
  ExrReader& operator=(ExrReader&&) noexcept;

  [[nodiscard]] Extent extent() const;                             ///< the display window
  [[nodiscard]] const std::vector<std::string>& channels() const;  ///< full names, in file order
  [[nodiscard]] const std::vector<std::string>& layers() const;
  [[nodiscard]] bool has_layer(std::string_view layer) const;

  /// All channels of a layer, R G B A or X Y Z W first and in that order. Pixels of the display
  /// window outside the data window are 0. Throws BadFile naming file and layer if the layer is
  /// missing, deep, subsampled or holds integers, or if the display window is larger than planes
  /// may be; std::runtime_error if it cannot be decoded, or is larger than the machine's memory.
  [[nodiscard]] std::vector<Plane<float>> read(std::string_view layer) const;
  /// The first N channels of a layer. Throws BadFile if it has fewer.
  template <int N>
  [[nodiscard]] Planes<N> read_planes(std::string_view layer) const {
    std::vector<Plane<float>> found = read(layer);
    check_channels(layer, found.size(), N);
    Planes<N> planes;
    for (std::size_t c = 0; c < N; ++c) planes[c] = std::move(found[c]);
    return planes;
  }
  /// Red, green and blue of a layer; of a gray one, its one channel three times. Throws BadFile if
  /// it has two.
  [[nodiscard]] Planes<3> read_colors(std::string_view layer) const;
  /// Where a layer has pixels, in pixels of the display window; may lie outside of it.
  [[nodiscard]] ExrWindow data_window(std::string_view layer) const;
  /// Primaries of the colors; those of Rec. 709 where the file does not say.
  [[nodiscard]] ExrChromaticities chromaticities() const;
  /// The first channel of a layer of integers. Throws BadFile if it is not of type uint.
  [[nodiscard]] Plane<std::uint32_t> read_uint(std::string_view layer) const;

  /// An attribute of the first part's header. Nothing if it is of another type.
  [[nodiscard]] std::optional<std::variant<int, float, std::string, ExrMatrix>> attribute(
      const std::string& name) const;

 private:
  struct State;
  void check_channels(std::string_view layer, std::size_t found, std::size_t wanted) const;

  std::unique_ptr<State> state_;
};

}  // namespace eigenlight
