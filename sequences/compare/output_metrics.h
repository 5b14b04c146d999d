// The frames that a method put out, measured against references in memory.
#pragma once

#include <cstdint>

#include "sequences/metrics/metrics.h"

namespace eigenlight {

/// What the outputs of all methods in one frame are measured against.
struct ReferenceFrame {
  int frame = 0;
  Planes<3> a, b;            ///< independent references
  Plane<std::uint8_t> bits;  ///< kSurfaceBit on the pixels that count, and kYoungBit or kOldBit
};

/// kSurfaceBit where there is a surface; there kYoungBit where `age` is below kYoungAge, else
/// kOldBit.
[[nodiscard]] Plane<std::uint8_t> surface_bits(const Plane<std::uint32_t>& id,
                                               const Plane<float>& age);

/// Measures the frames of one method in their order.
class OutputMetrics {
 public:
  explicit OutputMetrics(const MetricOptions& options) : metrics_(options) {}

  /// `test` shows what the references do; `second` may be an independent rendering of it, whose
  /// noise then drops out too (metrics.h). Pixels with NaN or Inf in any image are left out; those
  /// of the tests are counted.
  void add(const ReferenceFrame& references, Planes<3> test, Planes<3> second = {});

  [[nodiscard]] const std::vector<FrameFigures>& frames() const { return frames_; }
  [[nodiscard]] std::int64_t bad_pixels() const { return bad_pixels_; }

 private:
  SequenceMetrics metrics_;
  std::vector<FrameFigures> frames_;
  std::int64_t bad_pixels_ = 0;
};

}  // namespace eigenlight
