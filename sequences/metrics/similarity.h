// Similarity of two pictures: PSNR and SSIM.
#pragma once

#include "sequences/metrics/metrics.h"

namespace eigenlight {

struct Similarity {
  double psnr = 0.0;  ///< dB, peak 1; +inf for equal pictures
  double ssim = 0.0;
};

/// PSNR and SSIM (metrics.h) of display values over the pixels whose weight is positive. Both 0
/// where no pixel counts. Throws std::invalid_argument if sizes differ.
[[nodiscard]] Similarity similarity(const Planes<3>& found, const Planes<3>& wanted,
                                    const Plane<float>& weight, const MetricOptions& options);

/// The same for pictures that hold display values in [0, 1] already.
[[nodiscard]] Similarity similarity(const Planes<3>& found, const Planes<3>& wanted,
                                    const Plane<float>& weight);

}  // namespace eigenlight
