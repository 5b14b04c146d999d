#include "sequences/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sequences/evaluate_command.h"
#include "sequences/exr_io.h"
#include "sequences/ldr_image.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Extent kSize{16, 8};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Fake {
  float value = 0.5f;
  std::string layer = "indirect.";  ///< with the dot; empty: bare R, G, B
  Extent extent = kSize;
  bool has_masks = false;
  float first_pixel = -1.0f;  ///< in place of `value`, if not -1
};

// The left half has age 1, the right half age 9; the upper row has no surface.
void write_fake(const std::filesystem::path& path, const Fake& fake) {
  Plane<float> color(fake.extent), age(fake.extent);
  color.fill(fake.value);
  if (fake.first_pixel != -1.0f) color(0, 1) = fake.first_pixel;
  Plane<std::uint32_t> id(fake.extent);
  for (int y = 1; y < fake.extent.height; ++y) {
    for (int x = 0; x < fake.extent.width; ++x) {
      id(x, y) = 1;
      age(x, y) = x < fake.extent.width / 2 ? 1.0f : 9.0f;
    }
  }
  std::vector<ExrChannel> channels;
  for (const char* c : {"R", "G", "B"}) {
    channels.push_back({fake.layer + c, ExrType::kFloat, &color});
  }
  if (fake.has_masks) {
    channels.push_back({"id", ExrType::kUint, &id});
    channels.push_back({"age", ExrType::kFloat, &age});
  }
  write_exr(path, channels, {});
}

class EvaluateTest : public testing::Test {
 protected:
  // Frames 1-3: test 0.75 with masks against 0.5.
  void SetUp() override {
    for (const char* frame : {"0001", "0002", "0003"}) {
      write_fake(file("t", frame), {.value = 0.75f, .has_masks = true});
      write_fake(file("r", frame), {});
    }
  }
  std::filesystem::path file(const std::string& name, const std::string& frame) const {
    return dir_ / (name + "." + frame + ".exr");
  }
  EvaluateOptions options() const {
    EvaluateOptions o;
    o.test = file("t", "####").string();
    o.reference = file("r", "####").string();
    return o;
  }
  void expect_failure(const EvaluateOptions& o, const testing::Matcher<std::string>& what) const {
    EXPECT_THAT([&] { (void)evaluate(o); }, ThrowsMessage<std::runtime_error>(what));
  }
  // Standard output of `evaluate` with these words after it.
  std::string run(std::vector<std::string> words) const {
    CLI::App app;
    std::ostringstream out;
    add_evaluate_command(app, out);
    words.insert(words.begin(),
                 {"evaluate", "--test", options().test, "--reference", options().reference});
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(words);
    return out.str();
  }

  TempDir dir_;
};

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
  write_fake(dir_ / "oidn.exr", {.value = 0.75f, .layer = ""});
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
  write_fake(file("r", "0002"), {.extent = {8, 8}});
  EvaluateOptions o = options();
  expect_failure(o, AllOf(HasSubstr("t.0002.exr is 16x8"), HasSubstr("r.0002.exr is 8x8")));
  std::ofstream(file("r", "0002")) << "broken";
  expect_failure(o, HasSubstr("r.0002.exr"));
  o.skips_bad = true;
  EXPECT_EQ(evaluate(o).frames.size(), 2u);
}

TEST_F(EvaluateTest, PixelsThatAreNoNumbersAreCountedNotMeasured) {
  for (const float bad : {kNan, std::numeric_limits<float>::infinity()}) {
    write_fake(file("t", "0002"), {.value = 0.75f, .has_masks = true, .first_pixel = bad});
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
  for (const char* frame : {"0001", "0002", "0003"}) write_fake(file("b", frame), {.value = 1.0f});
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
  Plane<std::uint8_t> gray(kSize, 3), darker(kSize, 3);
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

TEST_F(EvaluateTest, JsonHasWhatWasMeasuredOnly) {
  const auto json = nlohmann::json::parse(run({"--json", "--frames", "1-2"}));
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["per_frame"].size(), 2u);
  EXPECT_NEAR(json["mean"]["relmse"].get<double>(), 0.0625 / 0.26, 1e-9);
  EXPECT_TRUE(json["mean"].contains("ssim"));
  EXPECT_TRUE(json["old"].contains("mse"));
  for (const char* absent : {"ms_ssim", "flicker", "reference_noise_relmse"}) {
    EXPECT_FALSE(json["mean"].contains(absent)) << absent;
  }
  EXPECT_FALSE(json["per_frame"][0].contains("temporal_error"));
  EXPECT_EQ(json["per_frame"][1]["temporal_error"], 0.0);
  EXPECT_FALSE(json["per_frame"][1].contains("tpsnr"));  // infinite
  EXPECT_TRUE(nlohmann::json::parse(run({"--json", "--flicker"}))["mean"].contains("flicker"));
}

TEST_F(EvaluateTest, TableAndDirectory) {
  const std::string table = run({"-o", (dir_ / "out").string()});
  EXPECT_THAT(table, AllOf(HasSubstr("3 frames; surface from test id"), HasSubstr("relmse"),
                           HasSubstr("sRGB(clamp(1 * value, 0, 1))")));
  std::ifstream file(dir_ / "out" / "evaluate.json");
  EXPECT_EQ(nlohmann::json::parse(file)["frames"], 3);
}

}  // namespace
}  // namespace eigenlight
