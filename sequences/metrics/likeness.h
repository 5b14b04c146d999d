// How alike two pictures are.
#pragma once

#include "sequences/metrics/metrics.h"

namespace eigenlight {

struct Likeness {
  double psnr = 0.0;  ///< dB, peak 1; +inf for equal pictures
  double ssim = 0.0;
};

/// PSNR and SSIM (metrics.h) of display values over the pixels whose weight is positive. Both 0
/// where no pixel counts. Throws std::invalid_argument if sizes differ.
[[nodiscard]] Likeness likeness(const Planes<3>& found, const Planes<3>& wanted,
                                const Plane<float>& weight, const MetricOptions& options);

/// The same of values in [0, 1] as they are.
[[nodiscard]] Likeness likeness(const Planes<3>& found, const Planes<3>& wanted,
                                const Plane<float>& weight);

}  // namespace eigenlight
