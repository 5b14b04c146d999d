// Structural similarity of two images, over any set of pixels.
#pragma once

#include <optional>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

struct SsimInputs {
  const Plane<double>& a;  ///< values in [0, 1]
  const Plane<double>& b;
  const Plane<double>&
      weight;  ///< [0, 1]: 0 keeps a pixel out of every window (its value is unread)
};

/// Maps of one scale, per pixel: luminance and contrast-structure; SSIM is their product.
struct SsimMaps {
  Plane<double> luminance;
  Plane<double> structure;
};

/// Wang et al. 2004: 11x11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03, L = 1. Windows that
/// leave the image or meet pixels of weight 0 are renormalized over what remains (the paper drops
/// such windows). Throws std::invalid_argument if sizes differ.
[[nodiscard]] SsimMaps ssim_maps(const SsimInputs& in);

/// Both images at up to 5 scales, each half the size of the one before (2x2 weighted means).
class SsimPyramid {
 public:
  /// One scale only for images with a side below 176, where the window would not fit the fifth.
  explicit SsimPyramid(const SsimInputs& in);

  /// Mean SSIM of the first scale over pixels weighted by `set`; absent if `set` is all 0.
  [[nodiscard]] std::optional<double> ssim(const Plane<double>& set) const;

  /// Wang et al. 2003, eq. 7: the product of mean structure at scales 1-4 and mean luminance *
  /// structure at scale 5, each to the power of its weight; a mean below 0 counts as 0. Absent
  /// without 5 scales, or if `set` is all 0.
  [[nodiscard]] std::optional<double> ms_ssim(const Plane<double>& set) const;

 private:
  std::vector<SsimMaps> scales_;
};

}  // namespace eigenlight
