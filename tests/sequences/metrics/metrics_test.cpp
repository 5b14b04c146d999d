#include "sequences/metrics/metrics.h"

#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace eigenlight {
namespace {

using Value = std::function<double(int x, int y)>;

Planes<3> image(Extent extent, const Value& value) {
  Planes<3> planes = make_planes<3>(extent);
  for (auto& plane : planes) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) plane(x, y) = static_cast<float>(value(x, y));
    }
  }
  return planes;
}

Planes<3> constant(Extent extent, double value) {
  return image(extent, [=](int, int) { return value; });
}

Planes<3> noise(Extent extent, double mean, double sigma, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(mean, sigma);
  return image(extent, [&](int, int) { return normal(engine); });
}

MetricFrame make_frame(Planes<3> test, Planes<3> reference) {
  MetricFrame frame;
  frame.bits = Plane<std::uint8_t>(test[0].extent());
  frame.bits.fill(kFiniteBit | kSurfaceBit);
  frame.test = std::move(test);
  frame.reference = std::move(reference);
  return frame;
}

Figures measure(MetricFrame frame, const MetricOptions& options = {}) {
  SequenceMetrics metrics(options);
  return metrics.add(std::move(frame))[PixelSet::kSurface];
}

double value(const Figures& figures, Metric metric) {
  EXPECT_TRUE(figures[metric].has_value()) << kMetricNames[static_cast<std::size_t>(metric)];
  return figures[metric].value_or(NAN);
}

constexpr Extent kSmall{13, 7};

TEST(Metrics, ConstantOffsetHasClosedForms) {
  const Figures f = measure(make_frame(constant(kSmall, 0.75), constant(kSmall, 0.5)));
  EXPECT_EQ(f.pixels, 91);
  EXPECT_NEAR(value(f, Metric::kMse), 0.0625, 1e-12);
  EXPECT_NEAR(value(f, Metric::kRelmse), 0.0625 / 0.26, 1e-12);
  EXPECT_NEAR(value(f, Metric::kSmape), 0.25 / 1.26, 1e-12);
  EXPECT_EQ(value(f, Metric::kLight), 0.75);
  EXPECT_EQ(value(f, Metric::kReferenceLight), 0.5);
  const double d = display_value(0.75, {}) - display_value(0.5, {});
  EXPECT_NEAR(value(f, Metric::kPsnr), -20.0 * std::log10(d), 1e-9);
}

TEST(Metrics, WhatWasNotMeasuredIsAbsent) {
  const Figures f = measure(make_frame(constant(kSmall, 1), constant(kSmall, 1)));
  for (const Metric absent : {Metric::kMsSsim, Metric::kTemporalError, Metric::kTpsnr,
                              Metric::kFlicker, Metric::kReferenceNoise}) {
    EXPECT_FALSE(f[absent].has_value()) << static_cast<int>(absent);
  }
  EXPECT_EQ(value(f, Metric::kMse), 0.0);
  EXPECT_EQ(value(f, Metric::kPsnr), std::numeric_limits<double>::infinity());
}

TEST(Metrics, DisplayCurveIsSrgbWithExposure) {
  MetricOptions options;
  options.exposure = 2.0f;
  EXPECT_NEAR(display_value(0.001, options), 0.002 * 12.92, 1e-12);
  EXPECT_NEAR(display_value(0.107, options), 0.5, 1e-3);  // 0.214 is mid gray
  EXPECT_EQ(display_value(-1.0, options), 0.0);
  EXPECT_NEAR(display_value(40.0, options), 1.0, 1e-12);
  options.is_display = true;
  EXPECT_EQ(display_value(0.3, options), 0.3);
}

// A checkerboard shifted by one pixel is wrong everywhere and has the opposite structure.
TEST(Metrics, CheckerboardShiftedByOnePixel) {
  const auto board = [](int x, int y) { return (x + y) % 2; };
  const auto shifted = [](int x, int y) { return (x + y + 1) % 2; };
  const Figures f = measure(make_frame(image({32, 32}, board), image({32, 32}, shifted)));
  EXPECT_NEAR(value(f, Metric::kMse), 1.0, 1e-12);
  EXPECT_NEAR(value(f, Metric::kPsnr), 0.0, 1e-9);
  EXPECT_LT(value(f, Metric::kSsim), -0.9);
}

// One column of n changes when an edge moves by one pixel.
TEST(Metrics, EdgeShiftedByOnePixel) {
  const auto edge = [](int at) { return [=](int x, int) { return x < at ? 0.0 : 1.0; }; };
  const Figures f = measure(make_frame(image({20, 9}, edge(10)), image({20, 9}, edge(11))));
  EXPECT_NEAR(value(f, Metric::kMse), 1.0 / 20, 1e-12);
}

TEST(Metrics, TemporalErrorSeesTheErrorChangeNotTheLight) {
  MetricOptions options;
  options.measures_flicker = true;
  SequenceMetrics metrics(options);
  (void)metrics.add(make_frame(constant(kSmall, 0.5), constant(kSmall, 0.25)));
  // The light doubles and the error stays: no temporal error, but a difference of frames.
  MetricFrame steady = make_frame(constant(kSmall, 0.75), constant(kSmall, 0.5));
  steady.follows = true;
  const Figures kept = metrics.add(std::move(steady))[PixelSet::kSurface];
  EXPECT_EQ(value(kept, Metric::kTemporalError), 0.0);
  EXPECT_NEAR(value(kept, Metric::kFlicker), 0.0625, 1e-12);
  EXPECT_EQ(value(kept, Metric::kFlickerUnseen), 0.0);
  // The light stands and the output steps by 1/256: error and flicker are the same.
  MetricFrame step = make_frame(constant(kSmall, 0.75 + 1.0 / 256), constant(kSmall, 0.5));
  step.follows = true;
  const Figures moved = metrics.add(std::move(step))[PixelSet::kSurface];
  EXPECT_NEAR(value(moved, Metric::kTemporalError), 1.0 / 65536, 1e-15);
  EXPECT_NEAR(value(moved, Metric::kFlicker), 1.0 / 65536, 1e-15);
  EXPECT_EQ(value(moved, Metric::kFlickerUnseen), 1.0);
  const double d = display_value(0.75 + 1.0 / 256, options) - display_value(0.75, options);
  EXPECT_NEAR(value(moved, Metric::kTpsnr), -20.0 * std::log10(d), 1e-6);
}

TEST(Metrics, AFrameThatDoesNotFollowHasNoTemporalFigures) {
  SequenceMetrics metrics({});
  (void)metrics.add(make_frame(constant(kSmall, 0.5), constant(kSmall, 0.25)));
  const FrameFigures f = metrics.add(make_frame(constant({3, 5}, 0.5), constant({3, 5}, 0.25)));
  EXPECT_FALSE(f[PixelSet::kSurface][Metric::kTemporalError].has_value());
}

TEST(Metrics, SetsCountTheirOwnPixelsOnly) {
  // Column 0 young and off by 1, column 1 old and off by 2, column 2 background, column 3 NaN.
  MetricFrame frame = make_frame(image({4, 2}, [](int x, int) { return x == 3 ? NAN : x + 1.0; }),
                                 constant({4, 2}, 0.0));
  constexpr std::uint8_t kColumns[4] = {kFiniteBit | kSurfaceBit | kYoungBit,
                                        kFiniteBit | kSurfaceBit | kOldBit, kFiniteBit,
                                        kSurfaceBit | kYoungBit};
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) frame.bits(x, y) = kColumns[x];
  }
  SequenceMetrics metrics({});
  const FrameFigures f = metrics.add(std::move(frame));
  EXPECT_EQ(f[PixelSet::kSurface].pixels, 4);
  EXPECT_NEAR(value(f[PixelSet::kSurface], Metric::kMse), 2.5, 1e-12);
  EXPECT_NEAR(value(f[PixelSet::kYoung], Metric::kMse), 1.0, 1e-12);
  EXPECT_NEAR(value(f[PixelSet::kOld], Metric::kMse), 4.0, 1e-12);
  EXPECT_TRUE(std::isfinite(value(f[PixelSet::kSurface], Metric::kSsim)));
}

TEST(Metrics, MeansAreOverFramesThatHaveTheFigure) {
  std::vector<FrameFigures> frames(3);
  frames[0].sets[0][Metric::kMse] = 1.0;
  frames[1].sets[0][Metric::kMse] = 3.0;
  frames[1].sets[0].pixels = 7;
  const SetFigures means = mean_figures(frames);
  EXPECT_EQ(means[0][Metric::kMse], 2.0);
  EXPECT_EQ(means[0].pixels, 7);
  EXPECT_FALSE(means[0][Metric::kRelmse].has_value());
}

TEST(Metrics, TwoReferencesMakeErrorFiguresUnbiased) {
  constexpr Extent kSize{400, 300};
  // Too bright and too dark in turn: the noise in the denominator of relMSE leaves a bias that
  // changes sign with the error, and otherwise 3 times its variance of 0.005.
  const auto board = [](int x, int y) { return (x + y) % 2 == 0 ? 1.1 : 0.9; };
  const auto two = [&](unsigned seed) {
    MetricFrame frame = make_frame(image(kSize, board), noise(kSize, 1.0, 0.1, seed));
    frame.reference_b = noise(kSize, 1.0, 0.1, seed + 1);
    return frame;
  };
  SequenceMetrics metrics({});
  const Figures first = metrics.add(two(1))[PixelSet::kSurface];
  // True squared error 0.01 beside reference noise of the same size. One pixel's product has a
  // standard deviation of 0.017, so the mean of 360,000 lies within 1.5e-4 (5 sigma).
  EXPECT_NEAR(value(first, Metric::kMse), 0.01, 1.5e-4);
  EXPECT_NEAR(value(first, Metric::kRelmse), 0.01 / 1.01, 4e-4);
  EXPECT_NEAR(value(first, Metric::kReferenceNoise), 0.005 / 1.01, 1e-4);
  // The error does not change over time, the noise does: sigma of the product 0.02.
  MetricFrame next = two(3);
  next.follows = true;
  const Figures second = metrics.add(std::move(next))[PixelSet::kSurface];
  EXPECT_NEAR(value(second, Metric::kTemporalError), 0.0, 2e-4);
  // A single reference cannot tell its own noise from error.
  const Figures single = measure(make_frame(image(kSize, board), noise(kSize, 1.0, 0.1, 1)));
  EXPECT_NEAR(value(single, Metric::kMse), 0.02, 5e-4);
}

TEST(Metrics, TwoTestsTakeTheNoiseOfTheTestsOutToo) {
  constexpr Extent kSize{400, 300};
  // Tests are 0.1 too bright, with as much noise; one pixel's product has a standard deviation of
  // 0.04.
  const auto two = [&](unsigned seed) {
    MetricFrame frame = make_frame(noise(kSize, 1.1, 0.1, seed), noise(kSize, 1.0, 0.1, seed + 1));
    frame.test_b = noise(kSize, 1.1, 0.1, seed + 2);
    frame.reference_b = noise(kSize, 1.0, 0.1, seed + 3);
    return frame;
  };
  SequenceMetrics metrics({});
  const Figures first = metrics.add(two(1))[PixelSet::kSurface];
  EXPECT_NEAR(value(first, Metric::kMse), 0.01, 4e-4);
  EXPECT_NEAR(first.energy().value(), 1.1, 1e-3);
  MetricFrame next = two(5);
  next.follows = true;
  EXPECT_NEAR(value(metrics.add(std::move(next))[PixelSet::kSurface], Metric::kTemporalError), 0.0,
              4e-4);
  MetricFrame single = two(1);
  single.test_b = {};
  EXPECT_NEAR(value(measure(std::move(single)), Metric::kMse), 0.02, 4e-4)
      << "one test cannot tell its noise from error";
}

TEST(Metrics, EnergyIsLightOverLightOfTheReference) {
  EXPECT_DOUBLE_EQ(
      measure(make_frame(constant(kSmall, 0.75), constant(kSmall, 0.5))).energy().value(), 1.5);
  EXPECT_FALSE(measure(make_frame(constant(kSmall, 0.75), constant(kSmall, 0.0))).energy());
  EXPECT_FALSE(Figures().energy());
}

TEST(Metrics, KnownReferenceNoiseIsSubtracted) {
  MetricOptions options;
  options.reference_noise = 0.1;
  const Figures f = measure(make_frame(constant(kSmall, 0.75), constant(kSmall, 0.5)), options);
  EXPECT_NEAR(value(f, Metric::kRelmse), 0.0625 / 0.26 - 0.1, 1e-12);
  EXPECT_EQ(value(f, Metric::kReferenceNoise), 0.1);
}

OIIO::ImageBuf to_buffer(const Planes<3>& planes) {
  OIIO::ImageBuf buffer(OIIO::ImageSpec(planes[0].width(), planes[0].height(), 3, OIIO::TypeFloat));
  for (int y = 0; y < planes[0].height(); ++y) {
    for (int x = 0; x < planes[0].width(); ++x) {
      const float pixel[3] = {planes[0](x, y), planes[1](x, y), planes[2](x, y)};
      buffer.setpixel(x, y, pixel);
    }
  }
  return buffer;
}

TEST(Metrics, AgreesWithOpenImageIo) {
  constexpr Extent kSize{61, 43};
  Planes<3> test = noise(kSize, 0.5, 0.05, 7), reference = noise(kSize, 0.5, 0.05, 8);
  reference[0](3, 4) = 1.0f;  // their peak is the largest value of either image, ours is 1
  const OIIO::ImageBuf a = to_buffer(test), b = to_buffer(reference);
  const auto theirs = OIIO::ImageBufAlgo::compare(a, b, 1e9f, 1e9f);
  MetricOptions options;
  options.is_display = true;
  const Figures ours = measure(make_frame(std::move(test), std::move(reference)), options);
  const double mse = theirs.rms_error * theirs.rms_error;
  EXPECT_NEAR(value(ours, Metric::kMse), mse, 1e-6 * mse);
  EXPECT_NEAR(value(ours, Metric::kPsnr), theirs.PSNR, 1e-4);
}

TEST(Metrics, BadInputsAreNamed) {
  MetricOptions options;
  options.exposure = 0.0f;
  EXPECT_THROW(SequenceMetrics{options}, std::invalid_argument);
  options.exposure = 1.0f;
  options.reference_noise = -1.0;
  EXPECT_THROW(SequenceMetrics{options}, std::invalid_argument);
  SequenceMetrics metrics({});
  EXPECT_THROW((void)metrics.add(make_frame(constant(kSmall, 1), constant({7, 13}, 1))),
               std::invalid_argument);
  MetricFrame one_reference = make_frame(constant(kSmall, 1), constant(kSmall, 1));
  one_reference.test_b = constant(kSmall, 1);
  EXPECT_THROW((void)metrics.add(std::move(one_reference)), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
