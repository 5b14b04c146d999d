// How far an image is from another, with its gradient.
#pragma once

#include "frame/plane.h"

namespace eigenlight {

struct ImageLoss {
  double absolute = 0.0;    ///< mean |a - b| over channels and pixels
  double structural = 0.0;  ///< mean of 1 - SSIM over channels and windows
  [[nodiscard]] double total() const;
};

/// The loss of `a` against `b`: L1 plus kStructuralShare times (1 - SSIM), SSIM as in Wang et al.
/// 2004 over 7 x 7 windows of equal weights that lie within the image (an image of a smaller side
/// has windows of that side), K1 = 0.01, K2 = 0.03, L = 1. It stands for the perceptual loss of Xu
/// et al. 2024, section 3.3.2, which needs a network. `gradient` receives d total() / da per
/// channel. Values are expected around [0, 1]. Throws std::invalid_argument if sizes differ.
[[nodiscard]] ImageLoss image_loss(const Planes<3>& a, const Planes<3>& b, Planes<3>& gradient);

}  // namespace eigenlight
