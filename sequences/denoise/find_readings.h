// What the guides of a sequence mean, found on its first frames.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sequences/conventions/camera_file.h"
#include "sequences/conventions/depth_reading.h"
#include "sequences/conventions/motion_reading.h"
#include "sequences/conventions/normal_reading.h"
#include "sequences/denoise/raw_frame.h"

namespace eigenlight {

/// What the user says about guides.
struct GuideChoice {
  std::string motion;  ///< as parse_motion() takes it; empty: found out
  std::string camera;  ///< a file, as CameraFile reads it; empty: one beside the sequence, if any
};

enum class CameraFrom { kNowhere, kFile, kHeader, kPosition };

/// What the guides of one view mean.
struct Readings {
  DepthReading depth;
  NormalReading normal;
  std::optional<MotionReading> motion;  ///< none: vectors are not used
  /// Without vectors and cameras: nothing moves, as far as the guides show.
  bool is_still = false;
  CameraFrom camera_from = CameraFrom::kNowhere;
  /// Positions are in the space of the camera: its lens is known, where it stands is not.
  bool in_view_space = false;
  std::optional<CameraFile> camera_file;
  std::vector<std::string> words;     ///< what was found, for people
  std::vector<std::string> warnings;  ///< what it costs, and what to do

  /// Whether cameras tell how pixels move from frame to frame.
  [[nodiscard]] bool knows_poses() const {
    return camera_from != CameraFrom::kNowhere && !in_view_space;
  }
};

/// Guides of a view as views of the planes of `frame`, which must outlive them.
[[nodiscard]] RawGuides raw_guides(const RawFrame& frame, const ViewPlan& view);

/// The camera that the attributes of a file describe, in pixels of its display window.
[[nodiscard]] std::optional<Camera> camera_of_header(const ExrFile& file);

/// The camera of a frame in pixels of the canvas.
[[nodiscard]] std::optional<Camera> find_camera(const RawFrame& frame, const ViewPlan& view,
                                                const Readings& readings, const ExrWindow& canvas);

/// Reads the first frames, two to four, in their order. `input`: the first input, beside which a
/// camera file may lie. Throws what CameraFile and parse_motion() throw.
[[nodiscard]] Readings find_readings(std::span<const RawFrame> frames, const ViewPlan& view,
                                     const ExrWindow& canvas, const GuideChoice& choice,
                                     const std::filesystem::path& input);

}  // namespace eigenlight
