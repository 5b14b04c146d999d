// Edge-avoiding a-trous passes for frames whose guides are noisy themselves.
#pragma once

#include <span>
#include <vector>

#include "frame/tiles.h"
#include "spatial/packed_guides.h"
#include "spatial/soft_atrous_kernel.h"

namespace eigenlight {

struct SoftAtrousOptions {
  int passes = 4;  ///< [1, 6]; pass i reaches radius * 2^i pixels
  int radius = 2;  ///< 1: 3 x 3 taps, 2: 5 x 5

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// A picture to filter in place.
struct SoftLayer {
  Planes<3>* light;
  Plane<float>* variance;  ///< of the light's luminance
  float sigmas = 5.0f;     ///< (0, 100] standard deviations that still count as the same light
};

/// As Atrous (atrous.h), with two differences. Guides are means over the samples of a pixel, and
/// noisy: weights of geometry are wide Gaussians of differences of the means themselves, in place
/// of distances from a plane and powers of a cosine,
///   g(p, q) = e(|n_p - n_q|^2 / normal^2 + |a_p - a_q|^2 / color^2
///               + (log z_p - log z_q)^2 / depth^2),
/// n the mean normal, which is shorter than 1 where samples differ. And light is compared by means
/// over 3 x 3 pixels of the same surface,
///   l(p) = sum_q h(q) g(p, q) luminance(q) / sum_q h(q) g(p, q),
/// with the variance of such a mean, in place of single pixels: an outlier is unlike all its
/// neighbors, and would keep its light to itself.
///   out(p) = sum_q k(q) w(p, q) c(q) / sum_q k(q) w(p, q),
///   w = g(p, q) * e(2 |l_p - l_q| / (d_p + d_q)),   d = sigmas * sigma + 1e-4 |l| + 1e-6,
/// the same for p in the sum of q: with d_p alone dark pixels, whose noise is small, refuse bright
/// ones, and these accept them, which costs 2 % of the light of skewed noise. k binomial (radius 1)
/// or B3 spline weights (radius 2), e(x) = (1 - x/8)^8 up to x = 8, then 0. Variances follow:
/// var(p) = sum (k w)^2 var(q) / (sum k w)^2. The weight of a pixel itself is k(0). Pixels without
/// surface (id 0), or whose light or variance is not finite, give nothing; such a pixel of a
/// surface takes what its neighbors give it, or 0 if their weights sum up to less than 1e-15.
///
/// Weights of geometry are calculated once for all layers. All instruction sets give the same bits.
class SoftAtrous {
 public:
  SoftAtrous(Extent extent, const SoftAtrousOptions& options);

  /// Throws std::invalid_argument if extents differ.
  void process(const Plane<PackedGuide>& guides, std::span<const SoftLayer> layers);

 private:
  struct Buffers {
    Planes<3> light;
    Plane<float> variance, mean, tolerance, usable, luminance;
  };

  void prepare(const Plane<PackedGuide>& guides);
  [[nodiscard]] std::vector<SoftWork> start(std::span<const SoftLayer> layers);

  Extent extent_;
  SoftAtrousOptions options_;
  SoftGuides guides_;
  std::vector<Plane<float>> near_;
  std::vector<Buffers> buffers_;
};

/// The variance of luminance around each pixel of one frame: over the 5 x 5 pixels that show a
/// surface and are finite. For light without history. NaN where a square overflows.
void variance_of_frame(const FrameInput& frame, const Planes<3>& light, Plane<float>& variance);

}  // namespace eigenlight
