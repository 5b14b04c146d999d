#include "sequences/metrics/similarity.h"

namespace eigenlight {

Similarity similarity(const Planes<3>& found, const Planes<3>& wanted, const Plane<float>& weight,
                      const MetricOptions& options) {
  const Extent extent = weight.extent();
  MetricFrame frame;
  frame.test = make_planes<3>(extent);
  frame.reference = make_planes<3>(extent);
  frame.bits = Plane<std::uint8_t>(extent);
  copy_planes(found, frame.test);
  copy_planes(wanted, frame.reference);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const bool counts = weight(x, y) > 0.0f;
      frame.bits(x, y) = static_cast<std::uint8_t>(counts ? kFiniteBit | kSurfaceBit : kFiniteBit);
    }
  }
  SequenceMetrics metrics(options);
  const Figures figures = metrics.add(std::move(frame))[PixelSet::kSurface];
  return {figures[Metric::kPsnr].value_or(0.0), figures[Metric::kSsim].value_or(0.0)};
}

Similarity similarity(const Planes<3>& found, const Planes<3>& wanted, const Plane<float>& weight) {
  MetricOptions as_they_are;
  as_they_are.is_display = true;
  return similarity(found, wanted, weight, as_they_are);
}

}  // namespace eigenlight
