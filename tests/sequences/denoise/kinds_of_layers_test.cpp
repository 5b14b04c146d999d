// Runs over layers that are not three channels of light: alpha, gray, positions, encoded vectors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frame/bad_file.h"
#include "frame/random.h"
#include "sequences/denoise/denoise_run.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "tests/support/fake_shot.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

constexpr Extent kExtent{64, 48};

class KindsOfLayers : public testing::Test {
 protected:
  std::filesystem::path in(int frame) const {
    return dir_ / ("s." + std::to_string(frame) + ".exr");
  }
  std::filesystem::path out(int frame) const {
    return dir_ / "out" / ("s." + std::to_string(frame) + ".exr");
  }
  DenoiseSettings settings() const {
    DenoiseSettings made;
    made.files = {{(dir_ / "s.%d.exr").string()}, (dir_ / "out").string(), "", true};
    return made;
  }
  static void run(const DenoiseSettings& settings) {
    const DenoisePlan plan = plan_denoising(settings);
    (void)run_denoising(settings, plan, {[] { return false; }, [](int) {}});
  }
  // value(x, y, channel) of each channel.
  template <typename Value>
  void write(int frame, const std::vector<std::string>& names, const Value& value) const {
    std::vector<Plane<float>> planes;
    for (std::size_t c = 0; c < names.size(); ++c) {
      planes.emplace_back(kExtent);
      for (int y = 0; y < kExtent.height; ++y) {
        for (int x = 0; x < kExtent.width; ++x) planes[c](x, y) = value(x, y, static_cast<int>(c));
      }
    }
    std::vector<ExrChannel> channels;
    for (std::size_t c = 0; c < names.size(); ++c) {
      channels.push_back({names[c], ExrType::kFloat, &planes[c]});
    }
    write_exr(in(frame), channels, {});
  }

  TempDir dir_;
};

float draw(int frame, int x, int y) {
  return to_unit(hash_key(static_cast<std::uint32_t>(frame), x, y));
}

struct Spread {
  double mean = 0.0, deviation = 0.0, least = 1e9, most = -1e9;
};

// Of the right half, a pixel away from its edges.
Spread spread(const Plane<float>& plane) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  Spread found;
  for (int y = 1; y < plane.height() - 1; ++y) {
    for (int x = plane.width() / 2 + 4; x < plane.width() - 1; ++x) {
      const double value = static_cast<double>(plane(x, y));
      sum += value, squares += value * value, count += 1.0;
      found.least = std::min(found.least, value);
      found.most = std::max(found.most, value);
    }
  }
  found.mean = sum / count;
  found.deviation = std::sqrt(std::max(squares / count - found.mean * found.mean, 0.0));
  return found;
}

TEST_F(KindsOfLayers, AlphaIsFilteredOnlyWhenAsked) {
  for (int frame = 1; frame <= 3; ++frame) {
    write(frame, {"R", "G", "B", "A"}, [&](int x, int y, int c) {
      const float alpha = x < kExtent.width / 2 ? 1.25f : (draw(frame, x, y) < 0.5f ? 0.0f : 1.0f);
      return c == 3 ? alpha : 0.5f * alpha;
    });
  }
  DenoiseSettings options = settings();
  run(options);
  const Plane<float> before = std::move(ExrReader(in(3)).read("").at(3));
  const Plane<float> kept = std::move(ExrReader(out(3)).read("").at(3));
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) ASSERT_EQ(kept(x, y), before(x, y));
  }
  options.layers.denoises_alpha = true;
  run(options);
  const std::vector<Plane<float>> after = ExrReader(out(3)).read("");
  const Spread noisy = spread(before), clean = spread(after.at(3));
  EXPECT_LT(clean.deviation, 0.4 * noisy.deviation);
  EXPECT_NEAR(clean.mean, noisy.mean, 0.03);
  EXPECT_GE(clean.least, 0.0);
  EXPECT_LE(clean.most, 1.0);
  EXPECT_EQ(after.at(3)(8, 24), 1.0f);  // beyond 1 there is no alpha
}

TEST_F(KindsOfLayers, AlphaThatIsOneEverywhereIsLeft) {
  for (int frame = 1; frame <= 2; ++frame) FakeShot().write(in(frame), frame);
  DenoiseSettings options = settings();
  options.layers.denoises_alpha = true;
  const DenoisePlan plan = plan_denoising(options);
  EXPECT_THAT(plan.notes, Contains(HasSubstr("alpha: none to denoise")));
  EXPECT_EQ(plan.layers.views.at(0).lights.size(), 1u);
  EXPECT_EQ(plan.layers.rows.back().role, "alpha");
  EXPECT_EQ(plan.layers.rows.back().why, "constant 1");
}

TEST_F(KindsOfLayers, AGrayBeautyIsLight) {
  for (int frame = 1; frame <= 3; ++frame) {
    write(frame, {"Y"}, [&](int x, int y, int) { return 0.5f + draw(frame, x, y); });
  }
  run(settings());
  const Spread before = spread(ExrReader(in(3)).read("Y").at(0));
  const Spread after = spread(ExrReader(out(3)).read("Y").at(0));
  EXPECT_LT(after.deviation, 0.4 * before.deviation);
  EXPECT_NEAR(after.mean, before.mean, 0.01);
}

// As Arnold leaves N_denoise empty once cryptomatte is on (arnold-usd#2167).
TEST_F(KindsOfLayers, GuidesThatAreZeroEverywhereAreAbsent) {
  for (int frame = 1; frame <= 2; ++frame) {
    write(frame, {"R", "G", "B", "N.X", "N.Y", "N.Z", "Z", "motion.X", "motion.Y"},
          [&](int x, int y, int c) { return c < 3 ? draw(frame, x, y) : 0.0f; });
  }
  const DenoisePlan plan = plan_denoising(settings());
  EXPECT_FALSE(plan.layers.views.at(0).normal || plan.layers.views[0].depth);
  EXPECT_TRUE(plan.layers.views[0].motion.has_value());  // nothing moves
  EXPECT_THAT(plan.notes, Contains("N: 0 everywhere, so it is not used as a guide"));
  EXPECT_THAT(plan.warnings, Contains(HasSubstr("normal: none")));
}

// Nine lights, each with its own noise: all are denoised, and they still add up to the beauty.
TEST_F(KindsOfLayers, ManyLightsAddUpToTheBeauty) {
  constexpr int kLights = 9;
  std::vector<std::string> names{"R", "G", "B"};
  DenoiseSettings options = settings();
  for (int light = 0; light < kLights; ++light) {
    for (const char* c : {"R", "G", "B"}) names.push_back("key" + std::to_string(light) + "." + c);
    options.layers.map.push_back("light=key" + std::to_string(light));
  }
  const auto light_at = [](int frame, int light, int x, int y) {
    return (0.2f + 0.1f * static_cast<float>(light)) * 2.0f * draw(100 * light + frame, x, y);
  };
  for (int frame = 1; frame <= 3; ++frame) {
    write(frame, names, [&](int x, int y, int c) {
      if (c >= 3) return light_at(frame, c / 3 - 1, x, y);
      float sum = 0.0f;
      for (int light = 0; light < kLights; ++light) sum += light_at(frame, light, x, y);
      return sum;
    });
  }
  EXPECT_EQ(plan_denoising(options).layers.views.at(0).lights.size(), std::size_t{kLights});
  run(options);
  const ExrReader before(in(3)), after(out(3));
  const Planes<3> beauty = after.read_planes<3>("color");
  Plane<double> sum(kExtent);
  for (int light = 0; light < kLights; ++light) {
    const std::string name = "key" + std::to_string(light);
    const Planes<3> noisy = before.read_planes<3>(name), clean = after.read_planes<3>(name);
    EXPECT_LT(spread(clean[0]).deviation, 0.4 * spread(noisy[0]).deviation) << light;
    EXPECT_NEAR(spread(clean[0]).mean / spread(noisy[0]).mean, 1.0, 0.02) << light;
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) sum(x, y) += static_cast<double>(clean[0](x, y));
    }
  }
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      ASSERT_NEAR(static_cast<double>(beauty[0](x, y)), sum(x, y), 1e-4);
    }
  }
}

// A curved surface that a pinhole at rest sees, in the space of the camera.
TEST_F(KindsOfLayers, PositionsInCameraSpaceTellNoMotion) {
  for (int frame = 1; frame <= 3; ++frame) {
    write(frame, {"R", "G", "B", "P.X", "P.Y", "P.Z", "Z"}, [&](int x, int y, int c) {
      if (c < 3) return 0.5f + draw(frame, x, y);
      const float z = 5.0f + std::sin(0.2f * static_cast<float>(x + frame)) +
                      std::cos(0.3f * static_cast<float>(y));
      const float u = (static_cast<float>(x) + 0.5f - 32.0f) / 60.0f;
      const float v = (static_cast<float>(y) + 0.5f - 24.0f) / 60.0f;
      return c == 3 ? u * z : c == 4 ? v * z : z;
    });
  }
  const DenoisePlan plan = plan_denoising(settings());
  EXPECT_THAT(plan.notes, Contains(HasSubstr("positions are in the space of the camera")));
  EXPECT_THAT(plan.notes, Each(Not(HasSubstr("motion: from cameras"))));
  EXPECT_THAT(plan.warnings, Contains(HasSubstr("each frame is denoised without history")));
}

TEST_F(KindsOfLayers, VectorsThatAreColorsAreToldAndNotUsed) {
  FakeShot shot;
  shot.has_encoded_motion = true;
  for (int frame = 1; frame <= 3; ++frame) shot.write(in(frame), frame);
  const DenoisePlan plan = plan_denoising(settings());
  EXPECT_THAT(plan.warnings, Contains(HasSubstr("View.Vector looks encoded as colors")));
  EXPECT_FALSE(plan.readings.at(0).motion.has_value());
}

TEST_F(KindsOfLayers, AFileThatVanishesIsNoBadFile) {
  for (int frame = 1; frame <= 4; ++frame) FakeShot().write(in(frame), frame);
  const DenoiseSettings options = settings();
  const DenoisePlan plan = plan_denoising(options);
  std::filesystem::remove(in(4));
  try {
    (void)run_denoising(options, plan, {[] { return false; }, [](int) {}});
    ADD_FAILURE() << "a missing file was not missed";
  } catch (const BadFile& error) {
    ADD_FAILURE() << error.what();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("s.4.exr: no such file"));
  }
}

}  // namespace
}  // namespace eigenlight
