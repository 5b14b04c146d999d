// Methods of ours on files, layer by layer.
#include "sequences/compare/recorded_method.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sequences/compare/recorded_plan.h"
#include "sequences/files/exr_io.h"
#include "tests/support/compare.h"
#include "tests/support/fake_shot.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

class RecordedMethodTest : public testing::Test {
 protected:
  // Three kinds of light, of different size and noise, with colors of their own.
  void write_shot(int frames) {
    for (int frame = 1; frame <= frames; ++frame) {
      const FakeShot shot{.extent = {40, 24}};
      ShotChannels file(shot, frame);
      const auto light = [&](int kind, int x, int y) {
        const float draw = to_unit(hash_key(static_cast<std::uint32_t>(100 * kind + frame), x, y));
        return static_cast<float>(kind) * (0.25f + draw);
      };
      for (int c = 0; c < 3; ++c) {
        const std::string letter(1, "RGB"[c]);
        const auto diffuse = [&](int y, int u) { return FakeShot::paint(u, y, c); };
        file.add("View.DiffDir." + letter, [&](int x, int y, int) { return light(1, x, y); });
        file.add("View.DiffInd." + letter, [&](int x, int y, int) { return light(2, x, y); });
        file.add("View.GlossInd." + letter, [&](int x, int y, int) { return light(3, x, y); });
        file.add("View.DiffCol." + letter, [&](int, int y, int u) { return diffuse(y, u); });
        file.add("View.GlossCol." + letter, [](int, int, int) { return 0.5f; });
        file.add("View.Combined." + letter, [&](int x, int y, int u) {
          return diffuse(y, u) * (light(1, x, y) + light(2, x, y)) + 0.5f * light(3, x, y);
        });
      }
      file.add("View.Depth.Z", [](int, int, int) { return 5.0f; });
      file.add("View.Vector.X", [&](int, int, int) { return static_cast<float>(shot.speed); });
      file.add("View.Vector.Y", [](int, int, int) { return 0.0f; });
      file.write(dir_ / ("s.000" + std::to_string(frame) + ".exr"));
    }
  }
  [[nodiscard]] DenoisePlan plan() const {
    DenoiseSettings settings;
    settings.files.inputs = {(dir_ / "s.####.exr").string()};
    settings.files.output = dir_ / "out";
    return plan_denoising(settings);
  }
  // Runs a method over all frames; the files of the last one.
  [[nodiscard]] std::vector<std::filesystem::path> run(const std::string& name) const {
    const DenoisePlan of_files = plan();
    RecordedMethod method(name, of_files);
    std::vector<std::filesystem::path> files;
    for (const FrameFiles& frame : of_files.frames) {
      const auto raw =
          std::make_shared<const RawFrame>(read_raw_frame(frame, of_files.layers, of_files.canvas));
      EXPECT_GE(method.step(raw), 0.0);
      files = write_channels(*raw, frame, method.compose(), dir_.path());
    }
    return files;
  }
  static double mean(const Planes<3>& planes) {
    double sum = 0.0;
    for (const auto& plane : planes) {
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) sum += static_cast<double>(plane(x, y));
      }
    }
    return sum / static_cast<double>(3 * planes[0].extent().pixels());
  }

  TempDir dir_;
};

TEST_F(RecordedMethodTest, TheNoisyMethodGivesBackEachLayerAndTheBeauty) {
  write_shot(3);
  const auto files = run("noisy");
  ASSERT_EQ(files.size(), 1u);
  const ExrReader after(files[0]), before(dir_ / "s.0003.exr");
  for (const char* layer : {"View.DiffDir", "View.DiffInd", "View.GlossInd", "View.Combined"}) {
    const Planes<3> a = after.read_planes<3>(layer), b = before.read_planes<3>(layer);
    for (int c = 0; c < 3; ++c) {
      for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 40; ++x) {
          ASSERT_NEAR(a[c](x, y), b[c](x, y), 2e-3f * b[c](x, y)) << layer << x << ' ' << y;
        }
      }
    }
  }
}

TEST_F(RecordedMethodTest, AMeanOverFramesTakesNoiseOutOfEachLayer) {
  write_shot(8);
  const auto files = run("mean");
  const ExrReader after(files[0]), before(dir_ / "s.0008.exr");
  const std::pair<const char*, double> lights[] = {
      {"View.DiffDir", 0.75}, {"View.DiffInd", 1.5}, {"View.GlossInd", 2.25}};
  for (const auto& [layer, expected] : lights) {
    const Planes<3> a = after.read_planes<3>(layer), b = before.read_planes<3>(layer);
    EXPECT_NEAR(mean(a), expected, 0.05 * expected) << layer;
    double noise_after = 0.0, noise_before = 0.0;
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 20; ++x) {  // what was in view all the time
        noise_after += std::pow(static_cast<double>(a[0](x, y)) - expected, 2);
        noise_before += std::pow(static_cast<double>(b[0](x, y)) - expected, 2);
      }
    }
    EXPECT_LT(noise_after, 0.3 * noise_before) << layer;
  }
}

TEST_F(RecordedMethodTest, FilesTakeTimeAndLeaveOneFile) {
  write_shot(2);
  EXPECT_GT(files_cpu_ms(plan(), {1, 2}, dir_.path()), 0.0);
  EXPECT_TRUE(std::filesystem::exists(dir_ / "0-s.0002.exr"));
}

}  // namespace
}  // namespace eigenlight
