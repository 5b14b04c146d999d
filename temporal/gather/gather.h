// Light of the frames around a frame, brought to it.
#pragma once

#include <span>
#include <vector>

#include "temporal/gather/light_change.h"
#include "temporal/gather/light_record.h"

namespace eigenlight {

/// Most frames on one side of a frame.
inline constexpr int kMostGathered = 64;

struct GatherOptions {
  /// [0, 100] d^2 / 2v up to which the light of another frame counts in full, d the difference of
  /// pilots and v their mean variance; and [0, 100] how fast weights fall beyond. Variances of
  /// pilots do not know that neighbors are filtered from the same samples, and are too small by
  /// about this factor.
  float soft = 4.0f, slope = 1.0f;
  /// (0, 10] Change of light, as a logarithm, at which another frame counts half: gains explain
  /// how bright light is, and not where it moved to.
  float change = 0.4f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// A frame on the way from the frame at hand.
struct GatherStep {
  const FrameLink* link;             ///< to it from the step before; first: from the frame at hand
  const Plane<PackedGuide>* guides;  ///< its own
  std::vector<const LightRecord*> lights;   ///< for each layer; nullptr: it gives no light
  std::vector<const LightChange*> changes;  ///< light of the step before over its; nullptr: 1
};

/// Frames before or after the frame at hand, the closest first.
using GatherWalk = std::vector<GatherStep>;

/// A layer of the frame at hand.
struct GatherLayer {
  const LightRecord* own;
  Planes<3>* light;        ///< in: the estimate so far; out: with the light of the other frames
  Plane<float>* variance;  ///< of its luminance
  /// Frames that the estimate holds. nullptr: it is the light of the frame alone, and that of
  /// others is tested pixel by pixel.
  const Plane<float>* count;
};

/// For each pixel p,
///   out = (n e + sum_j w_j g_j u_j) / (n + sum_j w_j),
/// e the estimate of n frames, at least 1, u_j the light of frame j at the place of p there,
/// between its four pixels by bilinear weights times guide_weight(), m_j the sum of these over
/// pixels whose light can be used, and g_j the product of changes on the way. A walk ends where
/// guides match by less than kLeastMatch in sum, or less than half of the way is known; a frame
/// counts where at least half of what matches can be used.
///
/// Without `count`, for light whose edges move over surfaces, weights are tests of the pilots s:
///   w_j = m_j falloff(slope max(0, (s_j - s)^2 / 2v - soft)),
/// v the mean over all frames, weighted by m_j, of the pilots' variances. What a frame's own noise
/// is must not decide how much the frame counts: bright outliers have large variances, dark pixels
/// small ones, and light would get lost.
///
/// With `count` there is no such test, for the same reason: weights depend on cells alone,
///   w_j = m_j / (1 + (max over the way of |log g| / change)^2).
///
/// Light that is not finite is left out: n = 0 where it is that of e. Variances: (n^2 var(e) + sum
/// (w_j g_j)^2 noise) / (n + sum w_j)^2, noise the mean over all frames, which stands for var(e)
/// without `count`. A pixel without surface, or for which no light is found, stays as it is.
void gather(const Plane<PackedGuide>& guides, const GuideWidths& widths,
            std::span<const GatherWalk> walks, std::span<const GatherLayer> layers,
            const GatherOptions& options);

}  // namespace eigenlight
