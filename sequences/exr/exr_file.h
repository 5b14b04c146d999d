// Reading OpenEXR files of any kind: parts, views, tiles, windows, types. Without names of layers
// that mean something; those are in sequences/files/exr_layers.h.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

enum class ExrType { kHalf, kFloat, kUint };

/// Values of channels that were written.
struct ExrOverflow {
  std::int64_t clamped = 0;     ///< finite, but beyond the range of half: written as +-65504
  std::int64_t not_finite = 0;  ///< NaN and Inf, written as they are
};

/// A rectangle of pixels in the coordinates of the display window.
struct ExrWindow {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const ExrWindow&, const ExrWindow&) = default;
};

struct ExrPart {
  std::string name;         ///< empty in most files of one part
  std::string view;         ///< attribute `view`, else empty
  std::string compression;  ///< `none`, `rle`, `zips`, `zip`, `piz`, `pxr24`, `b44`, `b44a`,
                            ///< `dwaa`, `dwab`
  ExrWindow data;           ///< the pixels that are in the file
  bool is_deep = false, is_tiled = false;
  int levels = 1;  ///< of a mip map or rip map, 1 without
};

struct ExrChannelInfo {
  int part = 0;      ///< index into parts()
  std::string name;  ///< as in the file
  /// The name behind the name of its part, `PART.NAME`; only the name where it starts with that of
  /// the part, and in files of one part.
  std::string full_name;
  /// The full name split at its last dot, without the view: `diffuse.left.R` in the view `left` is
  /// channel `R` of layer `diffuse`, and so is `diffuse.R` in a part `diffuse.left` of that view.
  /// Bare `R`, `G`, `B`, `A` are channels of layer "", other bare names are layers with channel "".
  std::string layer, channel;
  /// The view of its part, or that of its name in a file with attribute `multiView`; else empty.
  std::string view;
  ExrType type = ExrType::kHalf;
  int x_sampling = 1, y_sampling = 1;  ///< 2: every second pixel is in the file
};

/// For row vectors, as in OpenEXR: p' = p M, translation in the last row.
using ExrMatrix = std::array<float, 16>;

/// CIE 1931 xy of the primaries and of white.
struct ExrChromaticities {
  std::array<float, 2> red{}, green{}, blue{}, white{};
  friend bool operator==(const ExrChromaticities&, const ExrChromaticities&) = default;
};

/// `int`, `float`, `double`, `string`, `m44f` (m44d is rounded to it), `v2f`, `v3f`,
/// `chromaticities`, `stringvector`.
using ExrValue = std::variant<int, float, double, std::string, ExrMatrix, std::array<float, 2>,
                              std::array<float, 3>, ExrChromaticities, std::vector<std::string>>;

/// An open file. Members may be called from several threads; decoding is one at a time.
class ExrFile {
 public:
  /// Opens `path`, which stays open, and reads its headers. Throws BadFile if it is no OpenEXR
  /// file, std::runtime_error if it is not there, damaged, or not whole yet; both name the file in
  /// one line.
  explicit ExrFile(const std::filesystem::path& path);
  ~ExrFile();
  ExrFile(ExrFile&&) noexcept;
  ExrFile& operator=(ExrFile&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] std::uint64_t bytes() const;  ///< size of the file
  /// Of any size: files may have a huge display window and few pixels.
  [[nodiscard]] const ExrWindow& display_window() const;
  [[nodiscard]] const std::vector<ExrPart>& parts() const;
  /// Of all parts, deep ones too, in the order of the file: parts, then names by their bytes.
  [[nodiscard]] const std::vector<ExrChannelInfo>& channels() const;

  /// The pixels of some channels, by their index into channels(). Each plane has the extent of the
  /// data window of its part. Half values become floats exactly. All channels of one part are
  /// decoded at once. Throws BadFile naming file and channel if it is deep, subsampled or of
  /// integers, or if the data window cannot be that large; std::runtime_error if it cannot be
  /// decoded.
  [[nodiscard]] std::vector<Plane<float>> read(std::span<const int> channels) const;
  /// The same for one channel of type uint.
  [[nodiscard]] Plane<std::uint32_t> read_uint(int channel) const;

  /// Nothing if part `part` has no attribute of that name, or one of another type than ExrValue
  /// holds.
  [[nodiscard]] std::optional<ExrValue> attribute(const std::string& name, int part = 0) const;
  /// All attributes of a part, of any type.
  [[nodiscard]] std::vector<std::string> attribute_names(int part = 0) const;

  struct State;
  [[nodiscard]] State& state() const { return *state_; }  ///< for this folder only

 private:
  std::unique_ptr<State> state_;
};

/// Gives OpenEXR as many threads as we use.
void use_our_threads_for_exr();

}  // namespace eigenlight
