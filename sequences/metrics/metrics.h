// How far a sequence is from its reference, and how much it flickers. All sums in double.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

/// Figures of one frame, or their means over frames. Per pixel and channel x is the test, r the
/// reference, e = x - r. With two independent references A and B, r = (A + B) / 2 and the noise of
/// the references drops out of the figures marked (u), which may then be below 0. Noise in the
/// denominator of relMSE leaves a bias there, small while the references are cleaner than the test.
/// With two independent tests X and Y as well, x = (X + Y) / 2, and the products are those of X - A
/// and Y - B: the noise of the tests drops out too, and their bias stays.
///
/// LDR figures compare display values d(v) = sRGB(clamp(exposure * v, 0, 1)), whose peak is 1.
enum class Metric {
  kMse,            ///< (u) mean e^2; with two references mean (x - A)(x - B)
  kRelmse,         ///< (u) mean e^2 / (r^2 + 0.01); with two mean (x - A)(x - B) / (r^2 + 0.01)
  kPsnr,           ///< dB, -10 log10 mean (d(x) - d(r))^2; +inf for equal frames
  kSsim,           ///< of luma of display values, see ssim.h
  kMsSsim,         ///< the same over 5 scales; only for frames of 176 pixels a side or more
  kSmape,          ///< mean |e| / (|x| + |r| + 0.01), in [0, 1]
  kTemporalError,  ///< (u) mean (e_t - e_(t-1))^2; with two mean (eA_t - eA_(t-1))(eB_t - eB_(t-1))
  kTpsnr,          ///< dB, -10 log10 mean of (d(x) - d(r) now, less the same one frame ago)^2
  kReferenceNoise,  ///< relMSE of r itself: mean (A - B)^2 / (4 (r^2 + 0.01)), or as given
  kLight,           ///< mean x
  kReferenceLight,  ///< mean r; energy() is mean x over mean r
  kFlicker,         ///< mean (exposure * (x_t - x_(t-1)))^2 (Chen 2012, 4.2): camera at rest only
  kFlickerUnseen,   ///< 1 if flicker < 2.5e-5, else 0; its mean is the share of frame pairs
  kCount
};
inline constexpr std::size_t kMetricCount = static_cast<std::size_t>(Metric::kCount);
inline constexpr std::array<std::string_view, kMetricCount> kMetricNames{"mse",
                                                                         "relmse",
                                                                         "psnr",
                                                                         "ssim",
                                                                         "ms_ssim",
                                                                         "smape",
                                                                         "temporal_error",
                                                                         "tpsnr",
                                                                         "reference_noise_relmse",
                                                                         "light",
                                                                         "reference_light",
                                                                         "flicker",
                                                                         "flicker_unseen_share"};

/// Which pixels a figure is over. New pixels are where temporal filters fail, so they count apart.
enum class PixelSet { kSurface, kYoung, kOld, kCount };
inline constexpr std::size_t kPixelSetCount = static_cast<std::size_t>(PixelSet::kCount);
inline constexpr std::array<std::string_view, kPixelSetCount> kPixelSetNames{"mean", "young",
                                                                             "old"};
/// Pixels with history of fewer frames are young (they carry nearly half of a sequence's error).
inline constexpr float kYoungAge = 4.0f;

/// What a pixel is to the metrics: bits of a byte.
enum PixelBits : std::uint8_t {
  kFiniteBit = 1,   ///< test and references hold numbers here; else the pixel counts nowhere
  kSurfaceBit = 2,  ///< something is seen
  kYoungBit = 4,    ///< age < kYoungAge
  kOldBit = 8,      ///< age >= kYoungAge; neither bit where ages are not known
};

/// A figure is absent where it was not measured, never 0.
struct Figures {
  std::int64_t pixels = 0;
  std::array<std::optional<double>, kMetricCount> values;

  [[nodiscard]] std::optional<double>& operator[](Metric m) {
    return values[static_cast<std::size_t>(m)];
  }
  [[nodiscard]] const std::optional<double>& operator[](Metric m) const {
    return values[static_cast<std::size_t>(m)];
  }
  /// Mean of the test over mean of the reference: 1 where light is neither lost nor added. Absent
  /// where light was not measured or the reference is black.
  [[nodiscard]] std::optional<double> energy() const;
};

using SetFigures = std::array<Figures, kPixelSetCount>;

struct FrameFigures {
  int frame = 0;
  SetFigures sets;

  [[nodiscard]] const Figures& operator[](PixelSet s) const {
    return sets[static_cast<std::size_t>(s)];
  }
};

struct MetricOptions {
  float exposure = 1.0f;    ///< > 0, for LDR figures and flicker
  bool is_display = false;  ///< values are display values already (PNG): d(v) = clamp(v, 0, 1)
  bool measures_flicker = false;
  /// relMSE of a single reference against the truth, >= 0: subtracted from relmse.
  std::optional<double> reference_noise;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// One frame to be measured; all planes of one extent.
struct MetricFrame {
  int frame = 0;
  bool follows = false;  ///< temporal figures compare it with the frame added before
  Planes<3> test, reference;
  Planes<3> reference_b;     ///< empty without a second reference
  Planes<3> test_b;          ///< empty without a second test; needs a second reference
  Plane<std::uint8_t> bits;  ///< PixelBits
};

/// Measures frames in their order. Temporal figures need the pixel in the set now, and finite with
/// a surface one frame ago. A set without pixels has no figures.
class SequenceMetrics {
 public:
  explicit SequenceMetrics(const MetricOptions& options);

  /// Throws std::invalid_argument if planes differ in size, or from the frame before if `follows`.
  [[nodiscard]] FrameFigures add(MetricFrame frame);

 private:
  MetricOptions options_;
  std::optional<MetricFrame> previous_;
};

/// Per set the mean of each figure over the frames that have it; pixels are summed.
[[nodiscard]] SetFigures mean_figures(const std::vector<FrameFigures>& frames);

/// d(v) above, for one value.
[[nodiscard]] double display_value(double value, const MetricOptions& options);

}  // namespace eigenlight
