// Runs over a shot whose light is known.
#include "sequences/denoise/denoise_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frame/bad_file.h"
#include "sequences/denoise/memory_plan.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "tests/support/fake_shot.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class DenoiseRun : public testing::Test {
 protected:
  void write(const FakeShot& shot, int frames = 8) {
    for (int frame = 1; frame <= frames; ++frame) shot.write(in(frame), frame);
  }
  std::filesystem::path in(int frame) const {
    return dir_ / ("s." + std::to_string(frame) + ".exr");
  }
  std::filesystem::path out(int frame, const char* folder = "out") const {
    return dir_ / folder / ("s." + std::to_string(frame) + ".exr");
  }
  DenoiseSettings settings(const char* folder = "out") const {
    DenoiseSettings made;
    made.files = {{(dir_ / "s.%d.exr").string()}, (dir_ / folder).string(), "", false};
    return made;
  }
  /// Stops after `most` frames.
  static DenoiseTotals run(const DenoiseSettings& settings, int most = 1000) {
    const DenoisePlan plan = plan_denoising(settings);
    int asked = 0;
    return run_denoising(settings, plan, {[&] { return ++asked >= most; }, [](int) {}});
  }

  TempDir dir_;
};

struct Errors {
  double square = 0.0, energy = 0.0;
};

Errors errors(const FakeShot& shot, const std::filesystem::path& path, int frame) {
  const Planes<3> planes = ExrReader(path).read_planes<3>("color");
  double square = 0.0, found = 0.0, truth = 0.0;
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < shot.extent.height; ++y) {
      for (int x = 0; x < shot.extent.width; ++x) {
        const double value = static_cast<double>(planes[c](x, y));
        const double wanted = static_cast<double>(shot.beauty(frame, x, y, c));
        square += (value - wanted) * (value - wanted);
        found += value;
        truth += wanted;
      }
    }
  }
  return {square / (3.0 * static_cast<double>(shot.extent.pixels())), found / truth};
}

TEST_F(DenoiseRun, NoiseGoesAndLightStays) {
  const FakeShot shot;
  write(shot);
  EXPECT_EQ(run(settings()).frames, 8u);
  const Errors before = errors(shot, in(8), 8), after = errors(shot, out(8), 8);
  EXPECT_LT(after.square, before.square / 20.0);
  EXPECT_NEAR(after.energy, 1.0, 0.01);
}

TEST_F(DenoiseRun, PartsAddUpToTheBeauty) {
  write({}, 3);
  run(settings());
  const ExrReader file(out(3));
  const auto beauty = file.read_planes<3>("View.Combined"),
             light = file.read_planes<3>("View.DiffInd"),
             paint = file.read_planes<3>("View.DiffCol"), glow = file.read_planes<3>("View.Emit");
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 96; ++x) {
        const float sum = light[c](x, y) * paint[c](x, y) + glow[c](x, y);
        // Half rounds the sum and the light to 11 bits each.
        ASSERT_NEAR(beauty[c](x, y), sum, 1e-3f * sum);
      }
    }
  }
}

TEST_F(DenoiseRun, WhatIsNotDenoisedKeepsItsBits) {
  write({}, 2);
  run(settings());
  const ExrFile before(in(2)), after(out(2));
  ASSERT_EQ(before.channels().size(), after.channels().size());
  int equal = 0;
  for (std::size_t i = 0; i < before.channels().size(); ++i) {
    const std::string& name = before.channels()[i].full_name;
    EXPECT_EQ(name, after.channels()[i].full_name);
    EXPECT_EQ(before.channels()[i].type, after.channels()[i].type);
    if (before.channels()[i].type == ExrType::kUint) continue;
    const int channel[] = {static_cast<int>(i)};
    const Plane<float> a = std::move(before.read(channel)[0]),
                       b = std::move(after.read(channel)[0]);
    bool is_same = true;
    for (int y = 0; y < a.height(); ++y) {
      is_same = is_same && std::equal(a.row(y), a.row(y) + a.width(), b.row(y));
    }
    const bool is_new = name.find("DiffInd") != std::string::npos ||
                        (name.find("Combined") != std::string::npos && !name.ends_with(".A"));
    EXPECT_EQ(is_same, !is_new) << name;
    equal += is_same ? 1 : 0;
  }
  EXPECT_EQ(equal, 14);
  EXPECT_EQ(before.attribute("note"), after.attribute("note"));
}

TEST_F(DenoiseRun, AResumedRunHasTheBitsOfAnUninterruptedOne) {
  write({}, 6);
  run(settings("whole"));
  DenoiseSettings stopped = settings("stopped");
  stopped.checkpoint_seconds = 0.0;
  const DenoiseTotals first = run(stopped, 3);
  EXPECT_LT(first.frames, 6u);
  EXPECT_GT(first.frames, 0u);
  stopped.resume = true;
  // The state is that of the frame pushed last: what was written after it is written again.
  const std::size_t second = run(stopped).frames;
  EXPECT_GE(second, 6u - first.frames);
  EXPECT_LT(second, 6u);
  for (int frame = 1; frame <= 6; ++frame) {
    EXPECT_EQ(read_whole_file(out(frame, "whole")), read_whole_file(out(frame, "stopped")))
        << frame;
  }
  EXPECT_FALSE(std::filesystem::exists(dir_ / "stopped/.s.1.exr.eigenlight-state"));
}

TEST_F(DenoiseRun, WithoutLookaheadAnInterruptedRunLosesNoFrame) {
  write({}, 6);
  DenoiseSettings stopped = settings("stopped");
  stopped.lookahead = 0;
  const DenoiseTotals first = run(stopped, 3);
  stopped.resume = true;
  EXPECT_EQ(run(stopped).frames, 6u - first.frames);
}

TEST_F(DenoiseRun, LaterFramesLowerTheErrorOfTheFirstOne) {
  const FakeShot shot;
  write(shot, 6);
  DenoiseSettings causal = settings("causal");
  causal.lookahead = 0;
  run(causal);
  run(settings("ahead"));
  const Errors before = errors(shot, out(1, "causal"), 1), after = errors(shot, out(1, "ahead"), 1);
  EXPECT_LT(after.square, 0.75 * before.square);
  EXPECT_NEAR(after.energy, 1.0, 0.01);
}

TEST_F(DenoiseRun, LooksAheadNoFartherThanMemoryAllows) {
  write({}, 2);
  DenoiseSettings small = settings();
  const DenoisePlan whole = plan_denoising(small);
  EXPECT_EQ(whole.lookahead, 8);
  const MemoryPlan memory = plan_memory(whole.layers);
  small.max_memory = fmt::format("{:.0f}", memory.bytes(whole.canvas, 3) + 1.0);
  const DenoisePlan less = plan_denoising(small);
  EXPECT_EQ(less.lookahead, 3);
  EXPECT_THAT(less.warnings, testing::Contains(HasSubstr("lookahead 3 in place of 8")));
  small.max_memory = "1K";
  EXPECT_THAT([&] { (void)plan_denoising(small); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("bytes a pixel")));
}

TEST(MemoryPlan, AmountsAreNumbersWithAUnit) {
  EXPECT_EQ(parse_memory("8G"), 8.0 * 1024 * 1024 * 1024);
  EXPECT_EQ(parse_memory("1.5M"), 1.5 * 1024 * 1024);
  EXPECT_EQ(parse_memory("4096"), 4096.0);
  for (const char* bad : {"", "G", "8Gb", "-1G", "0", "nan", "8 G"}) {
    EXPECT_THROW((void)parse_memory(bad), std::invalid_argument) << bad;
  }
}

TEST_F(DenoiseRun, ACheckpointOfOtherOptionsIsRefused) {
  write({}, 6);
  DenoiseSettings options = settings();
  options.checkpoint_seconds = 0.0;
  run(options, 2);
  options.resume = true;
  options.cuts = "4";
  EXPECT_THAT([&] { run(options); },
              ThrowsMessage<BadFile>(HasSubstr("a run with other inputs or options")));
}

TEST_F(DenoiseRun, CompleteOutputsAreLeftAndBrokenOnesWrittenAgain) {
  write({}, 3);
  DenoiseSettings options = settings();
  run(options);
  const std::string good = read_whole_file(out(2));
  write_file_atomically(out(2), good.substr(0, good.size() / 2));
  options.skip_existing = true;
  const DenoiseTotals totals = run(options);
  EXPECT_EQ(totals.frames, 1u);
  EXPECT_EQ(totals.skipped, 2u);
  EXPECT_TRUE(read_whole_file(out(2)) == good);
}

TEST_F(DenoiseRun, NanIsCountedAndReplaced) {
  FakeShot shot;
  shot.nan_pixels = 5;
  write(shot, 4);
  const DenoiseTotals totals = run(settings());
  EXPECT_EQ(totals.not_finite.at("diffuse indirect"), 4 * 5);
  const Errors after = errors(shot, out(4), 4);
  EXPECT_TRUE(std::isfinite(after.square));
  EXPECT_NEAR(after.energy, 1.0, 0.02);
}

TEST_F(DenoiseRun, BeautyAloneIsDenoised) {
  FakeShot shot;
  shot.has_albedo = false;
  write(shot);
  DenoiseSettings options = settings();
  options.guides.motion = "cycles";
  run(options);
  EXPECT_LT(errors(shot, out(8), 8).square, errors(shot, in(8), 8).square / 1.5);
}

TEST_F(DenoiseRun, WithoutLightInItsPartsTheBeautyIsOneLayer) {
  Plane<float> some({32, 32}), none({32, 32});
  some.fill(0.5f);
  std::vector<ExrChannel> channels;
  for (const char* c : {"R", "G", "B"}) {
    channels.push_back({c, ExrType::kHalf, &some});
    channels.push_back({std::string("diffuse_direct.") + c, ExrType::kHalf, &none});
  }
  write_exr(in(1), channels, {});
  const DenoisePlan plan = plan_denoising(settings());
  ASSERT_EQ(plan.layers.views.at(0).lights.size(), 1u);
  EXPECT_EQ(plan.layers.views[0].lights[0].what, "beauty");
  EXPECT_EQ(run(settings()).frames, 1u);
}

TEST_F(DenoiseRun, ALayerThatEndsIsNamed) {
  write({}, 3);
  FakeShot other;
  other.has_albedo = false;
  other.write(in(3), 3);
  EXPECT_THAT([&] { run(settings()); },
              ThrowsMessage<BadFile>(HasSubstr("s.3.exr: no channel 'View.DiffInd.R'")));
}

TEST_F(DenoiseRun, CutsDropHistory) {
  FakeShot shot;
  write(shot, 6);
  DenoiseSettings options = settings();
  options.guides.motion = "cycles";
  DenoiseSettings steady = settings("steady");
  steady.guides.motion = "cycles";
  options.cuts = "6";
  run(options);
  run(steady);
  EXPECT_GT(errors(shot, out(6), 6).square, 1.5 * errors(shot, out(6, "steady"), 6).square);
}

}  // namespace
}  // namespace eigenlight
