// Light and colors of the frames around a frame, brought to it.
#pragma once

#include <span>
#include <vector>

#include "temporal/gather/frame_places.h"

namespace eigenlight {

/// What light of another frame counts as the same.
struct LightTest {
  /// [0, 1] Change of light, over the light itself, that is none.
  float tolerance = 0.05f;
  /// [0, 100] Ratio up to which another frame counts in full. Variances of pilots do not know that
  /// neighbors are filtered from the same samples, and are too small by about this factor.
  float soft = 8.0f;
  float slope = 0.5f;  ///< [0, 100] how fast weights fall beyond

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// A layer of light of the frame at hand.
struct GatherLayer {
  const LightRecord* own;
  LightTest test;
  Planes<3>* light;        ///< out; NaN where there is none
  Plane<float>* variance;  ///< out: of its luminance
};

/// A color of the frame at hand.
struct GatherColor {
  const ColorRecord* own;
  float width;       ///< > 0: difference, as a length, that weighs another frame by 1/e
  Planes<3>* color;  ///< out; NaN where its own is not usable
};

/// For each pixel p of a surface,
///   light(p) = (u + sum_j w_j u_j) / (1 + sum_j w_j),
/// u_j the light of frame j at the place of p there (FramePlaces), between its four pixels by the
/// weights of its taps, and m_j the sum of these over pixels whose light is usable; a frame counts
/// where that is at least half of all. Weights are tests of the pilots s around p:
///   w_j = m_j falloff(slope max(0, ratio - soft)),
///   ratio = sum_q k (s_j - s)^2 / (sum_q k V_j / 2 + sum_q k V / 2),
///   V_j = v_j + v + (tolerance max(|s_j|, |s|))^2,
/// k a tent over 5 x 5 pixels, v variances of pilots, and V the mean of v_j + v at p over all
/// frames, weighted by m_j. One pixel of a pilot says little; a window says it 9 times as well, and
/// is still narrow against what moves. What a frame's own noise is must decide as little as
/// possible on how much the frame counts: outliers have large variances, dark pixels small ones,
/// and light would get lost; V is there for that. What is still lost is given back by
/// even_light().
///
/// variance(p) = noise (1 + sum_j w_j^2) / (1 + sum_j w_j)^2, noise the mean of
/// RecordedLight::noise over all frames. Where the light of p is not usable its 1 is 0.
///
/// Colors alike, without windows, for they are seen and have little noise:
///   w_j = min(m_j, 1) falloff(|c_j - c|^2 / width^2) S_j,
/// S_j the sum of squared tap weights over the square of their sum: between pixels textures blur.
void gather(const Plane<PackedGuide>& guides, const GuideWidths& widths,
            std::span<const GatherWalk> walks, std::span<const GatherLayer> layers,
            std::span<const GatherColor> colors);

}  // namespace eigenlight
