// Outputs against references, in memory.
#pragma once

#include <cstdint>

#include "sequences/metrics/metrics.h"

namespace eigenlight {

/// What all methods are measured against in one frame.
struct JudgedFrame {
  int frame = 0;
  Planes<3> a, b;            ///< independent references: albedo * indirect light
  Plane<std::uint8_t> bits;  ///< kSurfaceBit, and one of kYoungBit and kOldBit
};

/// kSurfaceBit where there is a surface; there kYoungBit where `age` is below kYoungAge, else
/// kOldBit.
[[nodiscard]] Plane<std::uint8_t> surface_bits(const Plane<std::uint32_t>& id,
                                               const Plane<float>& age);

/// Measures the frames of one method in their order.
class Judge {
 public:
  explicit Judge(const MetricOptions& options) : metrics_(options) {}

  /// `test` is albedo * indirect light. Pixels with NaN or Inf in any of the three images are left
  /// out; those of the test are counted.
  void add(const JudgedFrame& truth, Planes<3> test);

  [[nodiscard]] const std::vector<FrameFigures>& frames() const { return frames_; }
  [[nodiscard]] std::int64_t bad_pixels() const { return bad_pixels_; }

 private:
  SequenceMetrics metrics_;
  std::vector<FrameFigures> frames_;
  std::int64_t bad_pixels_ = 0;
};

}  // namespace eigenlight
