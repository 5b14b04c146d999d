// Rows of the a-trous passes for noisy guides; see soft_atrous.h. Nothing is fused, so that all
// instruction sets give the same bits.
#pragma once

#include <span>
#include <vector>

#include "frame/frame.h"

namespace eigenlight {

/// Guides: normal, color, log depth, scaled so that squares of their differences sum up to x / 8 of
/// e(x).
inline constexpr std::size_t kSoftGuides = 7;
using SoftGuides = std::vector<Plane<float>>;
/// The last guide of a pixel without surface: no surface is near.
inline constexpr float kNoSoftSurface = 1e4f;

/// What the rows read and write of one layer.
struct SoftWork {
  Planes<3>* light;
  Plane<float>* variance;
  Plane<float>* usable;     ///< 1 or 0
  Plane<float>* luminance;  ///< of light
  Plane<float>* mean;       ///< l
  Plane<float>* tolerance;  ///< 4 d: then x / 8 of e(x) is |l_p - l_q| over the sum of both
  Planes<3>* out_light;
  Plane<float>* out_variance;
  float sigmas;
};

struct SoftPass {
  const SoftGuides& guides;
  /// Weights of geometry between a pixel and those to the right, below left, below, below right.
  const std::vector<Plane<float>>& near;
  std::span<const SoftWork> work;
  int radius, step;
  /// Surfaces may have pixels that are not usable; the first pass fills them.
  bool is_first;
};

/// Row y of the weights of geometry to near pixels; 0 for those beside the image.
void soft_near_row(const SoftGuides& guides, int y, std::vector<Plane<float>>& near);
/// Finds which pixels of row y are usable, sets the others to 0, and takes the luminance of all.
void soft_start_row(const SoftGuides& guides, const SoftWork& work, int y);
/// Means of luminance over 3 x 3 pixels of the same surface, and what counts as the same light.
void soft_means_row(const SoftPass& pass, int y);
/// Filters light and variance of row y, and takes the luminance of the result.
void soft_filter_row(const SoftPass& pass, int y);
/// Row y of variance_of_frame().
void soft_variance_row(const FrameInput& frame, const Planes<3>& light, int y,
                       Plane<float>& variance);

}  // namespace eigenlight
