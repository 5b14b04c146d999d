// What a depth layer means: along the view axis, or along the ray.
#pragma once

#include <span>
#include <string>

#include "frame/camera.h"
#include "frame/plane.h"
#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

/// What the depths of a file mean.
struct DepthReading {
  bool along_ray = false;  ///< distance from the eye; else along the view axis
  double scale = 1.0;      ///< the file's value times this is in the units of camera and positions
};

/// Readings compared. From positions, residuals are the median of |depth / expected - 1|; from
/// normals, the median angle in degrees between them and the slope of depth.
struct DepthFit {
  DepthReading reading;
  double axis_residual = 0.0, ray_residual = 0.0;
  bool is_clear = false;  ///< false: nothing to compare with, or no difference; then along the axis
  std::string words;      ///< one line for people
};

/// Compares depth with positions and camera where there are both, else with normals and camera
/// (planes seen at an angle are planar in the right reading only). One to four frames.
[[nodiscard]] DepthFit find_depth(std::span<const RawGuides> frames);

/// Depth in our convention: along the view axis, +inf in the background. `camera` may be null where
/// the reading is along the axis; along the ray without a camera throws std::invalid_argument.
void apply_depth(const Plane<float>& raw, const DepthReading& reading, const Camera* camera,
                 Plane<float>& depth);

}  // namespace eigenlight
