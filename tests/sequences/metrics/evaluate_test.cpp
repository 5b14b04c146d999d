#include "sequences/metrics/evaluate.h"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sequences/cli/evaluate_command.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/ldr_image.h"
#include "sequences/runs/flythrough.h"
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
  std::string perturb = {};   ///< what the header says; empty: nothing
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
  std::vector<ExrAttribute> attributes;
  if (!fake.perturb.empty()) attributes.push_back({kPerturbAttribute, fake.perturb});
  write_exr(path, channels, attributes);
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

// A step from 0.25 to 0.5 at frame 5, which the test follows by halves.
class EvaluateStepTest : public EvaluateTest {
 protected:
  void SetUp() override {
    float missing = 0.25f;
    for (int frame = 4; frame <= 10; ++frame) {
      const std::string number = fmt::format("{:04}", frame);
      const float light = frame < 5 ? 0.25f : 0.5f;
      if (frame >= 5) missing *= 0.5f;
      write_fake(file("t", number), {.value = frame < 5 ? light : light - missing});
      write_fake(file("r", number), {.value = light});
      write_fake(file("h", number), {.value = light, .perturb = "step:5"});
    }
  }
};

TEST_F(EvaluateStepTest, LagIsMeasuredWhereAsked) {
  const auto json = nlohmann::json::parse(run({"--json", "--step", "5"}));
  EXPECT_EQ(json["step"], 5);
  // 1/2, 3/4, 7/8, 15/16 of it at frames 5 to 8.
  EXPECT_EQ(json["mean"]["lag_frames"], 3);
  const double squares = 1.0 / 64 + 1.0 / 256 + 1.0 / 1024 + 1.0 / 4096;
  EXPECT_NEAR(json["mean"]["lag_error"].get<double>(), squares / 0.26, 1e-9);
  EXPECT_FALSE(json["per_frame"][0].contains("step_reached"));
  EXPECT_NEAR(json["per_frame"][1]["step_reached"].get<double>(), 0.5, 1e-9);
  EXPECT_THAT(run({"--step", "5"}), HasSubstr("lag: 3 frames after the light step at 5"));
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

TEST_F(EvaluateStepTest, AStepThatIsNotReachedHasNoLag) {
  const std::vector<std::string> early{"--step", "5", "--frames", "4-6"};
  auto words = early;
  words.push_back("--json");
  const auto json = nlohmann::json::parse(run(words));
  EXPECT_FALSE(json["mean"].contains("lag_frames"));
  EXPECT_FALSE(json["mean"].contains("lag_error"));
  EXPECT_NEAR(json["per_frame"][2]["step_reached"].get<double>(), 0.75, 1e-9);
  EXPECT_THAT(run(early), HasSubstr("not 90 % of the light step at 5, 75.0 % at most"));
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
    OIIO::ImageBuf picture(OIIO::ImageSpec(kSize.width, kSize.height, 3, OIIO::TypeUInt8));
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

TEST_F(EvaluateTest, TableAndDirectory) {
  const std::string table = run({"-o", (dir_ / "out").string()});
  EXPECT_THAT(table, AllOf(HasSubstr("3 frames; surface from test id"), HasSubstr("relmse"),
                           HasSubstr("sRGB(clamp(1 * value, 0, 1))")));
  std::ifstream file(dir_ / "out" / "evaluate.json");
  EXPECT_EQ(nlohmann::json::parse(file)["frames"], 3);
}

}  // namespace
}  // namespace eigenlight
