#include "sequences/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <utility>

#include "frame/tiles.h"
#include "sequences/metrics/ssim.h"

namespace eigenlight {
namespace {

constexpr double kRelmseFloor = 0.01;       // as in the definition of relMSE
constexpr double kSmapeFloor = 0.01;        // keeps black pixels from counting as 100 % wrong
constexpr double kVisibleFlicker = 2.5e-5;  // Chen 2012, 4.2
constexpr std::array<std::uint8_t, kPixelSetCount> kSetBits{kSurfaceBit, kYoungBit, kOldBit};

// Sums over pixels and channels; per pixel the terms of one channel each.
struct Sums {
  std::int64_t pixels = 0, temporal_pixels = 0;
  double square = 0.0, relative = 0.0, display = 0.0, smape = 0.0, noise = 0.0;
  double test = 0.0, reference = 0.0;
  double temporal = 0.0, temporal_display = 0.0, flicker = 0.0;

  void add(const Sums& other) {
    pixels += other.pixels;
    temporal_pixels += other.temporal_pixels;
    square += other.square;
    relative += other.relative;
    display += other.display;
    smape += other.smape;
    noise += other.noise;
    test += other.test;
    reference += other.reference;
    temporal += other.temporal;
    temporal_display += other.temporal_display;
    flicker += other.flicker;
  }
};

using SetSums = std::array<Sums, kPixelSetCount>;

bool has_two(const MetricFrame& frame) { return !frame.reference_b[0].empty(); }

// One channel of one pixel of one frame.
struct Sample {
  // Both tests and both references, the same one twice where there is one; means of the pairs.
  double xa, xb, a, b, x, r;
  double display_error;
};

Sample sample_at(const MetricFrame& frame, std::size_t channel, glm::ivec2 p,
                 const MetricOptions& options) {
  Sample s{};
  s.xa = static_cast<double>(frame.test[channel](p.x, p.y));
  s.xb = frame.test_b[0].empty() ? s.xa : static_cast<double>(frame.test_b[channel](p.x, p.y));
  s.a = static_cast<double>(frame.reference[channel](p.x, p.y));
  s.b = has_two(frame) ? static_cast<double>(frame.reference_b[channel](p.x, p.y)) : s.a;
  s.x = 0.5 * (s.xa + s.xb);
  s.r = 0.5 * (s.a + s.b);
  s.display_error = display_value(s.x, options) - display_value(s.r, options);
  return s;
}

void add_still(const Sample& s, Sums& sums) {
  const double product = (s.xa - s.a) * (s.xb - s.b);
  const double scale = 1.0 / (s.r * s.r + kRelmseFloor);
  sums.square += product;
  sums.relative += product * scale;
  sums.display += s.display_error * s.display_error;
  sums.smape += std::abs(s.x - s.r) / (std::abs(s.x) + std::abs(s.r) + kSmapeFloor);
  sums.test += s.x;
  sums.reference += s.r;
  sums.noise += 0.25 * (s.a - s.b) * (s.a - s.b) * scale;
}

void add_temporal(const Sample& now, const Sample& before, float exposure, Sums& sums) {
  sums.temporal +=
      (now.xa - before.xa - (now.a - before.a)) * (now.xb - before.xb - (now.b - before.b));
  const double display = now.display_error - before.display_error;
  sums.temporal_display += display * display;
  const double exposed = static_cast<double>(exposure) * (now.x - before.x);
  sums.flicker += exposed * exposed;
}

constexpr std::uint8_t kUsable = kFiniteBit | kSurfaceBit;

bool is_usable(std::uint8_t bits) { return (bits & kUsable) == kUsable; }

SetSums sum_row(const MetricFrame& frame, const MetricFrame* previous, int y,
                const MetricOptions& options) {
  SetSums row;
  for (int x = 0; x < frame.bits.width(); ++x) {
    const std::uint8_t bits = frame.bits(x, y);
    if (!is_usable(bits)) continue;
    const bool is_temporal = previous && is_usable(previous->bits(x, y));
    Sums pixel;
    pixel.pixels = 1;
    pixel.temporal_pixels = is_temporal ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Sample now = sample_at(frame, c, {x, y}, options);
      add_still(now, pixel);
      if (!is_temporal) continue;
      add_temporal(now, sample_at(*previous, c, {x, y}, options), options.exposure, pixel);
    }
    for (std::size_t s = 0; s < kPixelSetCount; ++s) {
      if (bits & kSetBits[s]) row[s].add(pixel);
    }
  }
  return row;
}

// Row sums are added in row order: the same bits for any number of threads.
SetSums sum_frame(const MetricFrame& frame, const MetricFrame* previous,
                  const MetricOptions& options) {
  std::vector<SetSums> rows(static_cast<std::size_t>(frame.bits.height()));
  parallel_for(frame.bits.height(), [&](int y) {
    rows[static_cast<std::size_t>(y)] = sum_row(frame, previous, y, options);
  });
  SetSums total;
  for (const SetSums& row : rows) {
    for (std::size_t s = 0; s < kPixelSetCount; ++s) total[s].add(row[s]);
  }
  return total;
}

// Infinite where nothing differs.
double decibels(double mean_square) {
  return mean_square == 0.0 ? std::numeric_limits<double>::infinity()
                            : -10.0 * std::log10(mean_square);
}

void fill_temporal(const Sums& sums, const MetricOptions& options, Figures& out) {
  if (sums.temporal_pixels == 0) return;
  const double scale = 1.0 / (3.0 * static_cast<double>(sums.temporal_pixels));
  out[Metric::kTemporalError] = sums.temporal * scale;
  out[Metric::kTpsnr] = decibels(sums.temporal_display * scale);
  if (!options.measures_flicker) return;
  out[Metric::kFlicker] = sums.flicker * scale;
  out[Metric::kFlickerUnseen] = sums.flicker * scale < kVisibleFlicker ? 1.0 : 0.0;
}

Figures to_figures(const Sums& sums, const MetricOptions& options, bool two_references) {
  Figures out;
  out.pixels = sums.pixels;
  if (sums.pixels == 0) return out;
  const double scale = 1.0 / (3.0 * static_cast<double>(sums.pixels));
  out[Metric::kMse] = sums.square * scale;
  out[Metric::kRelmse] = sums.relative * scale - options.reference_noise.value_or(0.0);
  out[Metric::kPsnr] = decibels(sums.display * scale);
  out[Metric::kSmape] = sums.smape * scale;
  out[Metric::kLight] = sums.test * scale;
  out[Metric::kReferenceLight] = sums.reference * scale;
  out[Metric::kReferenceNoise] = options.reference_noise;
  if (two_references) out[Metric::kReferenceNoise] = sums.noise * scale;
  fill_temporal(sums, options, out);
  return out;
}

struct LumaImages {
  Plane<double> test, reference, weight;
};

LumaImages display_luma(const MetricFrame& frame, const MetricOptions& options) {
  constexpr std::array<double, 3> kRec709{0.2126, 0.7152, 0.0722};
  const Extent extent = frame.bits.extent();
  LumaImages luma{Plane<double>(extent), Plane<double>(extent), Plane<double>(extent)};
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      if (!(frame.bits(x, y) & kFiniteBit)) continue;
      luma.weight(x, y) = 1.0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Sample s = sample_at(frame, c, {x, y}, options);
        luma.test(x, y) += kRec709[c] * display_value(s.x, options);
        luma.reference(x, y) += kRec709[c] * display_value(s.r, options);
      }
    }
  });
  return luma;
}

void fill_similarity(const MetricFrame& frame, const MetricOptions& options, SetFigures& sets) {
  const LumaImages luma = display_luma(frame, options);
  const SsimInputs inputs{luma.test, luma.reference, luma.weight};
  const SsimPyramid pyramid(inputs);
  Plane<double> members(frame.bits.extent());
  for (std::size_t s = 0; s < kPixelSetCount; ++s) {
    if (sets[s].pixels == 0) continue;
    for (int y = 0; y < members.height(); ++y) {
      for (int x = 0; x < members.width(); ++x) {
        const std::uint8_t bits = frame.bits(x, y);
        members(x, y) = is_usable(bits) && (bits & kSetBits[s]) ? 1.0 : 0.0;
      }
    }
    sets[s][Metric::kSsim] = pyramid.ssim(members);
    sets[s][Metric::kMsSsim] = pyramid.ms_ssim(members);
  }
}

void check_planes(const MetricFrame& frame) {
  const Extent extent = frame.bits.extent();
  check_extent(extent);
  for (std::size_t c = 0; c < 3; ++c) {
    EL_CHECK(frame.test[c].extent() == extent && frame.reference[c].extent() == extent &&
                 (frame.reference_b[c].empty() || frame.reference_b[c].extent() == extent) &&
                 (frame.test_b[c].empty() || frame.test_b[c].extent() == extent),
             "frame {}: tests, references and pixel bits must have one size", frame.frame);
  }
  EL_CHECK(frame.test_b[0].empty() || has_two(frame),
           "frame {}: a second test needs a second reference", frame.frame);
}

}  // namespace

double display_value(double value, const MetricOptions& options) {
  if (options.is_display) return std::clamp(value, 0.0, 1.0);
  const double v = std::clamp(value * static_cast<double>(options.exposure), 0.0, 1.0);
  // The sRGB curve, IEC 61966-2-1.
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

std::optional<double> Figures::energy() const {
  const auto& light = (*this)[Metric::kLight];
  const auto& reference = (*this)[Metric::kReferenceLight];
  if (!light || !reference || *reference == 0.0) return std::nullopt;
  return *light / *reference;
}

void MetricOptions::validate() const {
  EL_CHECK(exposure > 0.0f && std::isfinite(exposure), "exposure {}: must be above 0", exposure);
  EL_CHECK(!reference_noise || (*reference_noise >= 0.0 && std::isfinite(*reference_noise)),
           "reference_noise {}: must be 0 or more", *reference_noise);
}

SequenceMetrics::SequenceMetrics(const MetricOptions& options) : options_(options) {
  options_.validate();
}

FrameFigures SequenceMetrics::add(MetricFrame frame) {
  check_planes(frame);
  const MetricFrame* previous = frame.follows && previous_ ? &*previous_ : nullptr;
  EL_CHECK(!previous || previous->bits.extent() == frame.bits.extent(),
           "frame {}: size differs from the frame before", frame.frame);
  const SetSums sums = sum_frame(frame, previous, options_);
  FrameFigures figures;
  figures.frame = frame.frame;
  for (std::size_t s = 0; s < kPixelSetCount; ++s) {
    figures.sets[s] = to_figures(sums[s], options_, has_two(frame));
  }
  fill_similarity(frame, options_, figures.sets);
  previous_ = std::move(frame);
  return figures;
}

SetFigures mean_figures(const std::vector<FrameFigures>& frames) {
  SetFigures means;
  for (std::size_t s = 0; s < kPixelSetCount; ++s) {
    for (const FrameFigures& frame : frames) means[s].pixels += frame.sets[s].pixels;
    for (std::size_t m = 0; m < kMetricCount; ++m) {
      double sum = 0.0;
      std::int64_t count = 0;
      for (const FrameFigures& frame : frames) {
        const auto& value = frame.sets[s].values[m];
        if (!value) continue;
        sum += *value;
        ++count;
      }
      if (count > 0) means[s].values[m] = sum / static_cast<double>(count);
    }
  }
  return means;
}

}  // namespace eigenlight
