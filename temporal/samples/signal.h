// The mean of a pixel's regular and extra samples, and the variance of new pixels.
#pragma once

#include "frame/frame.h"
#include "frame/tiles.h"
#include "temporal/samples/pixel_counts.h"

namespace eigenlight {

struct SignalInputs {
  const FrameInput& frame;
  const Planes<3>& raw;              ///< the samples of one layer of its light
  const Plane<std::uint8_t>* extra;  ///< samples granted beyond frame.spp, or null: none
  const Planes<3>* extra_mean;       ///< of those, where there are any; null with `extra`; may be
                                     ///< the same as SignalOutputs::light
  const Plane<float>& age;           ///< of the history
};

struct SignalOutputs {
  Planes<3>& light;       ///< mean of all samples; NaN where it is not usable
  Plane<float>& samples;  ///< all samples over frame.spp; 0 where the light is not usable
};

/// Fills the pixels of a tile at most kSegment wide. Light is usable on surfaces where the sum of
/// its channels' magnitudes is at most kLargestLight. Counts fresh and non_finite pixels alone.
PixelCounts merge_samples(const SignalInputs& in, const Rect& tile, const SignalOutputs& out);

struct FreshInputs {
  const FrameInput& frame;
  const Planes<3>& raw;            ///< the samples of one layer of its light
  const Plane<float>& samples;     ///< as merge_samples leaves it, for the whole image
  const Plane<float>& age;         ///< of the history
  const Plane<float>& brightness;  ///< of blocks of 8 x 8 pixels, for the whole image
};

/// One frame's variance at new pixels (age 0): that of luminance over the usable pixels of the 7 x
/// 7 around. Texture counts as noise until history separates them. 0 if only one pixel is usable.
/// Luminance is clamped to the `brightness` of its block (FireflyBound): otherwise a firefly in the
/// first frame would raise the bound for all fireflies that follow.
void fresh_variance(const FreshInputs& in, const Rect& tile, Plane<float>& variance);

struct EstimateInputs {
  const Plane<std::uint32_t>& id;
  const Plane<float>& age;       ///< with this frame
  const Plane<float>& variance;  ///< of one frame's luminance
  float young;                   ///< frames below which a pixel counts as young
};

struct EstimateOutputs {
  Plane<float>& variance;      ///< of the temporal estimate: variance / age, 0 without age
  Plane<std::uint8_t>& young;  ///< 1 on young surfaces, else 0
};

/// Fills the inputs of the spatial filters for the pixels of `tile`.
void estimate_variance(const EstimateInputs& in, const Rect& tile, const EstimateOutputs& out);

}  // namespace eigenlight
