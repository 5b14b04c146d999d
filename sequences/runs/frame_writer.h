// The EXR file of a frame, with named layers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "frame/frame.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"

namespace eigenlight {

/// The layers of a frame file. All radiance is linear Rec. 709 and not clamped.
///   color     R,G,B        albedo * (direct + indirect) + emission, or its antialiased picture;
///                          the unnamed layer
///   indirect  R,G,B        albedo * denoised indirect
///   noisy     R,G,B        albedo * raw indirect of the frame's own samples, NaN and Inf kept
///   direct    R,G,B        albedo * direct, denoised unless the run keeps it noisy
///   noisy_direct R,G,B     albedo * raw direct of the frame's own samples
///   emission  R,G,B        of the first hit, or of the sky
///   albedo    R,G,B
///   N         X,Y,Z        world space
///   Z                      depth along the view axis; +inf where there is no surface
///   P         X,Y,Z        world space
///   motion    X,Y          pixels; the point at p was at p + motion in the previous frame
///   id                     object, 0 where there is no surface
///   age                    frames' worth of samples behind the pixel
/// color = direct + indirect + emission unless it is antialiased; all other layers come from the
/// guide rays.
enum class Layer {
  kColor,
  kIndirect,
  kNoisy,
  kDirect,
  kNoisyDirect,
  kEmission,
  kAlbedo,
  kNormal,
  kDepth,
  kPosition,
  kMotion,
  kId,
  kAge
};

/// The layers of a comma-separated list, in the order above and once each; empty text: all. Throws
/// std::invalid_argument listing the known names.
[[nodiscard]] std::vector<Layer> parse_layers(std::string_view text);
[[nodiscard]] std::string format_layers(const std::vector<Layer>& layers);

/// Standard attributes of a camera. worldToCamera: x right, y up, z forward. worldToNDC: x right, y
/// down, (0, 0) and (1, 1) at the upper left and lower right corners after division by w; z is 1 /
/// w.
[[nodiscard]] ExrMatrix world_to_camera(const Camera& camera);
[[nodiscard]] ExrMatrix world_to_ndc(const Camera& camera, Extent extent);

/// A frame and its denoised light.
struct DenoisedFrame {
  const Frame& frame;
  const Planes<3>& indirect;  ///< denoised, over albedo
  const Plane<float>& age;
  const Planes<3>* picture = nullptr;  ///< the layer color; null: composed from the others
  const Planes<3>* direct = nullptr;   ///< denoised, over albedo; null: that of the frame
};

/// Writes frames into a directory. Radiance, albedo, N and age are half; Z, P and motion are float;
/// id is uint. A layer with a finite value beyond the range of half (65504) is written as float in
/// that frame, so that nothing is clamped and the layers still add up.
class FrameWriter {
 public:
  /// `attributes` go into every file, with the camera and the frame number.
  FrameWriter(std::filesystem::path directory, std::vector<Layer> layers,
              std::vector<ExrAttribute> attributes);

  /// Throws std::runtime_error naming the file if it cannot be written.
  void write(const DenoisedFrame& denoised);
  [[nodiscard]] std::filesystem::path path(int frame) const;

 private:
  void add(Layer layer, const DenoisedFrame& denoised);
  void add_planes(std::string_view layer, std::string_view axes, const Plane<float>* planes,
                  bool wide);
  [[nodiscard]] std::vector<ExrAttribute> attributes_of(const Frame& frame) const;

  std::filesystem::path directory_;
  FilePattern pattern_{kFramePattern};
  std::vector<Layer> layers_;
  std::vector<ExrAttribute> attributes_;
  std::vector<ExrChannel> channels_;
  std::vector<Planes<3>> scratch_;  // one for each radiance layer of the frame in hand
  std::size_t used_scratch_ = 0;
};

}  // namespace eigenlight
