#include "sequences/metrics/evaluate.h"

#include <OpenImageIO/imagebufalgo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "sequences/files/ldr_image.h"
#include "tests/support/fake_images.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST_F(EvaluateTest, MatchesByFrameNumberAndTakesSetsFromTheTest) {
  const Evaluation e = evaluate(options());
  ASSERT_EQ(e.frames.size(), 3u);
  EXPECT_EQ(e.frames[2].frame, 3);
  EXPECT_EQ(e.surface_from, "test id");
  EXPECT_EQ(e.age_from, "test age");
  EXPECT_EQ(e.frames[0][PixelSet::kSurface].pixels, 16 * 7);
  EXPECT_EQ(e.frames[0][PixelSet::kYoung].pixels, 8 * 7);
  EXPECT_NEAR(e.mean[0][Metric::kMse].value(), 0.0625, 1e-12);
  EXPECT_EQ(e.mean[0][Metric::kTemporalError].value(), 0.0);
  EXPECT_FALSE(e.frames[0][PixelSet::kSurface][Metric::kTemporalError].has_value());
}

TEST_F(EvaluateTest, BareLayersTakeSetsFromTheReference) {
  write_fake_image(dir_ / "oidn.exr", {.value = 0.75f, .layer = ""});
  EvaluateOptions o;
  o.test = (dir_ / "oidn.exr").string();
  o.reference = file("t", "0001").string();
  expect_failure(o, AllOf(HasSubstr("oidn.exr"), HasSubstr("no layer 'indirect'")));
  for (const char* name : {"", "color"}) {
    o.test_layer = name;
    const Evaluation e = evaluate(o);
    EXPECT_EQ(e.surface_from, "reference id");
    EXPECT_EQ(e.mean[0][Metric::kMse].value(), 0.0);
  }
}

TEST_F(EvaluateTest, HalvesOfOneFileAreNamedBehindAColon) {
  write_fake_image(dir_ / "test.exr", {.value = 0.75f, .layer = "ViewLayer.Combined."});
  write_fake_image(dir_ / "ref.exr", {.value = 0.5f, .layer = "HalfA.Combined."});
  write_fake_image(dir_ / "other.exr", {.value = 0.7f, .layer = "HalfB.DiffDir."});
  EvaluateOptions o;
  o.test = (dir_ / "test.exr").string();
  o.reference = (dir_ / "ref.exr:HalfA").string();
  EXPECT_NEAR(evaluate(o).mean[0][Metric::kMse].value(), 0.0625, 1e-12);
  o.reference = (dir_ / "other.exr:HalfB").string();
  expect_failure(o, AllOf(HasSubstr("other.exr"), HasSubstr("no layer 'HalfB.color'")));
  o.layer = "direct";
  o.test_layer = "color";
  EXPECT_NEAR(evaluate(o).mean[0][Metric::kMse].value(), 0.0025, 1e-7);
}

TEST_F(EvaluateTest, FramesAcrossAGapAreNotCompared) {
  for (const char* frame : {"0011", "0012"}) {
    write_fake_image(file("t", frame), {.value = 0.9f, .has_masks = true});
    write_fake_image(file("r", frame), {});
  }
  EvaluateOptions o = options();
  o.frames = "1,2,11,12";
  const Evaluation e = evaluate(o);
  EXPECT_EQ(e.frames[1][PixelSet::kSurface][Metric::kTemporalError].value(), 0.0);
  EXPECT_FALSE(e.frames[2][PixelSet::kSurface][Metric::kTemporalError].has_value());
  o.frames = "1,3";  // every second frame: these are neighbors
  EXPECT_TRUE(evaluate(o).mean[0][Metric::kTemporalError].has_value());
}

TEST_F(EvaluateTest, AFileOfThatNameIsNoPattern) {
  write_fake_image(dir_ / "shot@2x.exr", {.value = 0.75f});
  EvaluateOptions o;
  o.test = (dir_ / "shot@2x.exr").string();
  o.reference = file("r", "0001").string();
  EXPECT_NEAR(evaluate(o).mean[0][Metric::kMse].value(), 0.0625, 1e-12);
}

TEST_F(EvaluateTest, MissingFramesAreNamedAndCounted) {
  std::filesystem::remove(file("t", "0002"));
  EvaluateOptions o = options();
  expect_failure(o, AllOf(HasSubstr("t.0002.exr: no such file"),
                          HasSubstr("1 of 3 frames are incomplete: 2")));
  o.skips_bad = true;
  const Evaluation e = evaluate(o);
  EXPECT_EQ(e.frames.size(), 2u);
  ASSERT_EQ(e.skipped.size(), 1u);
  EXPECT_EQ(e.skipped[0].frame, 2);
  EXPECT_FALSE(e.mean[0][Metric::kTemporalError].has_value());  // 3 does not follow 1
  o.skips_bad = false;
  o.frames = "3,1";
  EXPECT_EQ(evaluate(o).frames[0].frame, 3);
  o.frames = "8-9";
  expect_failure(o, HasSubstr("2 of 2 frames are incomplete: 8-9"));
  o.skips_bad = true;
  expect_failure(o, HasSubstr("no frame could be measured"));
}

TEST_F(EvaluateTest, SizesAndBrokenFilesAreNamed) {
  write_fake_image(file("r", "0002"), {.extent = {8, 8}});
  EvaluateOptions o = options();
  expect_failure(o, AllOf(HasSubstr("t.0002.exr is 16x8"), HasSubstr("r.0002.exr is 8x8")));
  std::ofstream(file("r", "0002")) << "broken";
  expect_failure(o, HasSubstr("r.0002.exr"));
  o.skips_bad = true;
  EXPECT_EQ(evaluate(o).frames.size(), 2u);
}

TEST_F(EvaluateTest, PixelsThatAreNoNumbersAreCountedNotMeasured) {
  for (const float bad : {kNan, std::numeric_limits<float>::infinity()}) {
    write_fake_image(file("t", "0002"), {.value = 0.75f, .has_masks = true, .first_pixel = bad});
    EvaluateOptions o = options();
    expect_failure(o, AllOf(HasSubstr("t.0002.exr: 1 pixels with NaN or Inf"),
                            HasSubstr("the first at (0, 1)")));
    o.skips_bad = true;
    const Evaluation e = evaluate(o);
    EXPECT_EQ(e.bad_pixels, 1);
    EXPECT_EQ(e.frames[1][PixelSet::kSurface].pixels, 16 * 7 - 1);
    EXPECT_NEAR(e.frames[1][PixelSet::kSurface][Metric::kMse].value(), 0.0625, 1e-12);
  }
}

TEST_F(EvaluateTest, TwoReferencesMeasureTheirNoise) {
  for (const char* frame : {"0001", "0002", "0003"})
    write_fake_image(file("b", frame), {.value = 1.0f});
  EvaluateOptions o = options();
  o.reference_b = file("b", "####").string();
  const Evaluation e = evaluate(o);
  EXPECT_NEAR(e.mean[0][Metric::kMse].value(), -0.0625, 1e-12);  // (0.25)(-0.25)
  EXPECT_NEAR(e.mean[0][Metric::kReferenceNoise].value(), 0.0625 / (0.5625 + 0.01), 1e-12);
  o.metrics.reference_noise = 0.1;
  EXPECT_THROW((void)evaluate(o), std::invalid_argument);
  o = options();
  o.reference_b = o.reference;
  EXPECT_THROW((void)evaluate(o), std::invalid_argument);
}

TEST_F(EvaluateTest, PicturesCompareAsStored) {
  Plane<std::uint8_t> gray(kFakeSize, 3), darker(kFakeSize, 3);
  gray.fill(128);
  darker.fill(77);
  for (const auto& [name, picture] : {std::pair{"a.jpg", &gray}, std::pair{"b.jpg", &darker}}) {
    const auto bytes = encode_jpeg(*picture, 100);
    std::ofstream(dir_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  EvaluateOptions o;
  o.test = (dir_ / "a.jpg").string();
  o.reference = (dir_ / "b.jpg").string();
  const Evaluation e = evaluate(o);
  EXPECT_NEAR(e.mean[0][Metric::kMse].value(), 0.04, 1e-4);  // 51 / 255 = 0.2
  EXPECT_NEAR(e.mean[0][Metric::kPsnr].value(), 13.979, 0.02);
  EXPECT_EQ(e.surface_from, "all pixels");
  o.reference = file("r", "0001").string();
  EXPECT_THROW((void)evaluate(o), std::invalid_argument);
}

TEST_F(EvaluateStepTest, TheStepIsFoundInTheFiles) {
  EvaluateOptions o = options();
  EXPECT_FALSE(evaluate(o).lag.has_value());
  o.reference = file("h", "####").string();
  const Evaluation e = evaluate(o);
  EXPECT_EQ(e.step, 5);
  ASSERT_TRUE(e.lag.has_value());
  EXPECT_EQ(e.lag->frames, 3);
  // The file knows of a step, but these frames do not show it.
  o.frames = "7-9";
  EXPECT_EQ(evaluate(o).step, 5);
  EXPECT_FALSE(evaluate(o).lag.has_value());
}

TEST_F(EvaluateStepTest, AStepThatIsNotThereIsAnError) {
  EvaluateOptions o = options();
  o.step = 7;
  expect_failure(o, HasSubstr("step 7: expected mean light of the reference to change by 10 %"));
  o.step = 5;
  o.frames = "5-9";
  expect_failure(o, HasSubstr("between frames 4 and 5, both measured"));
}

TEST_F(EvaluateTest, PngComparesAsStored) {
  const auto write = [&](const char* name, float value) {
    OIIO::ImageBuf picture(OIIO::ImageSpec(kFakeSize.width, kFakeSize.height, 3, OIIO::TypeUInt8));
    const float color[3] = {value, value, value};
    OIIO::ImageBufAlgo::fill(picture, color);
    ASSERT_TRUE(picture.write((dir_ / name).string()));
  };
  write("a.png", 128.0f / 255.0f);
  write("b.png", 77.0f / 255.0f);
  EvaluateOptions o;
  o.test = (dir_ / "a.png").string();
  o.reference = (dir_ / "b.png").string();
  EXPECT_NEAR(evaluate(o).mean[0][Metric::kMse].value(), 0.04, 1e-8);  // 51 / 255 = 0.2
  EXPECT_NEAR(evaluate(o).mean[0][Metric::kPsnr].value(), 13.9794, 1e-4);
}

}  // namespace
}  // namespace eigenlight
