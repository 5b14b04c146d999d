// What is kept of a layer of light of a frame, for the frames around it.
#pragma once

#include <span>
#include <vector>

#include "spatial/soft_atrous.h"

namespace eigenlight {

/// One pixel: its light as it was rendered, and the luminance of the pilot, which is the frame
/// filtered on its own, with its variance. noise: (luminance of light - pilot)^2, a sample of the
/// variance of light that does not hold what the pilot resolves: edges of shadows. usable: 1, or 0
/// where there is no surface or light is not finite, and all others are 0.
struct RecordedLight {
  float r, g, b, pilot, pilot_variance, noise, usable, unused;
};
using LightRecord = Plane<RecordedLight>;

/// Makes the records of all layers of a frame.
class LightRecorder {
 public:
  LightRecorder(Extent extent, int layers, const SoftAtrousOptions& filter, float sigmas);

  /// Throws std::invalid_argument if extents or the number of layers differ.
  void record(const FrameInput& frame, const Plane<PackedGuide>& guides,
              std::span<LightRecord> records);

 private:
  float sigmas_;
  SoftAtrous filter_;
  std::vector<Planes<3>> pilots_;
  std::vector<Plane<float>> variances_;
};

}  // namespace eigenlight
