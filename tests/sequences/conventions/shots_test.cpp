// Readings of files that Blender's Cycles wrote, where they are at hand: in the folder that
// EIGENLIGHT_SEQUENCES names, or beside the project in shared/sequences.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "sequences/conventions/camera_file.h"
#include "sequences/conventions/camera_solve.h"
#include "sequences/conventions/checks.h"
#include "sequences/conventions/depth_reading.h"
#include "sequences/conventions/motion_reading.h"
#include "sequences/conventions/normal_reading.h"
#include "sequences/files/exr_io.h"

namespace eigenlight {
namespace {

struct Shot {
  std::string name;
  int first = 0;
};

void PrintTo(const Shot& shot, std::ostream* out) { *out << shot.name << " from " << shot.first; }

std::filesystem::path sequences() {
  if (const char* folder = std::getenv("EIGENLIGHT_SEQUENCES")) return folder;
  return std::filesystem::path(EIGENLIGHT_ROOT) / ".." / "shared" / "sequences";
}

class CyclesShot : public ::testing::TestWithParam<Shot> {
 protected:
  void SetUp() override {
    const Shot& shot = GetParam();
    const std::filesystem::path folder = sequences() / ("cycles-" + shot.name);
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    const CameraFile cameras(folder / (shot.name + ".camera.json"));
    for (int frame = shot.first; frame < shot.first + 2; ++frame) {
      const std::string number = std::to_string(10000 + frame).substr(1);
      const ExrReader file(folder / (shot.name + "." + number + ".exr"));
      RawGuides guides;
      guides.frame = frame;
      guides.depth = std::move(file.read("Z")[0]);
      guides.normal = file.read_planes<3>("N");
      guides.albedo = file.read_planes<3>("albedo");
      guides.motion = file.read("motion");
      guides.camera = cameras.camera(frame, file.extent());
      if (file.has_layer("ViewLayer.Position")) {
        guides.position = file.read_planes<3>("ViewLayer.Position");
      }
      if (file.has_layer("ViewLayer.Denoising Normal")) {
        in_camera_space_.push_back(file.read_planes<3>("ViewLayer.Denoising Normal"));
      }
      light_ = file.read_planes<3>("indirect");
      frames_.push_back(std::move(guides));
    }
  }

  std::vector<RawGuides> frames_;
  std::vector<Planes<3>> in_camera_space_;
  Planes<3> light_;
};

TEST_P(CyclesShot, MotionIsBackwardInPixelsWithYUp) {
  const MotionFit fit = find_motion(frames_);
  EXPECT_TRUE(fit.is_clear) << fit.words;
  EXPECT_EQ(fit.best, (MotionReading{0, 1.0, -1.0, true})) << fit.words;
  EXPECT_LT(fit.residual, 0.2) << fit.words;
}

TEST_P(CyclesShot, DepthIsAlongTheAxis) {
  const DepthFit fit = find_depth(frames_);
  EXPECT_TRUE(fit.is_clear) << fit.words;
  EXPECT_FALSE(fit.reading.along_ray) << fit.words;
  for (RawGuides& frame : frames_) frame.position = {};
  const DepthFit by_normals = find_depth(frames_);
  EXPECT_TRUE(by_normals.is_clear) << by_normals.words;
  EXPECT_FALSE(by_normals.reading.along_ray) << by_normals.words;
}

TEST_P(CyclesShot, NormalsAreInWorldSpaceAndThoseForDenoisersInCameraSpace) {
  const NormalFit world = find_normal(frames_, {});
  EXPECT_TRUE(world.is_clear) << world.words;
  EXPECT_FALSE(world.reading.in_camera_space) << world.words;
  EXPECT_FALSE(world.reading.is_encoded);
  if (in_camera_space_.empty()) return;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    frames_[i].normal = std::move(in_camera_space_[i]);
  }
  const NormalFit camera = find_normal(frames_, {});
  EXPECT_TRUE(camera.is_clear) << camera.words;
  EXPECT_TRUE(camera.reading.in_camera_space) << camera.words;
  EXPECT_FALSE(camera.reading.is_encoded);
}

TEST_P(CyclesShot, PositionsGiveTheCamera) {
  if (frames_[0].position[0].empty()) GTEST_SKIP() << "no positions";
  for (const RawGuides& frame : frames_) {
    const auto fit = solve_camera(frame.position, frame.depth);
    ASSERT_TRUE(fit);
    EXPECT_LT(fit->residual, 0.01);
    EXPECT_LT(glm::length(fit->camera.eye - frame.camera->eye), 1e-3f);
    EXPECT_NEAR(fit->camera.focal, frame.camera->focal, 1e-2f);
  }
}

TEST_P(CyclesShot, HasNothingToComplainAbout) {
  EXPECT_FALSE(check_correlated_noise(light_, frames_[1]));
  EXPECT_FALSE(check_noisy_feature(frames_[1].albedo, light_, "albedo"));
  EXPECT_FALSE(is_cut(frames_[1], frames_[0], {}));
}

INSTANTIATE_TEST_SUITE_P(All, CyclesShot,
                         ::testing::Values(Shot{"tiny", 33}, Shot{"sponza", 5}, Shot{"room", 5},
                                           Shot{"room", 20}),
                         [](const auto& named) {
                           return named.param.name + std::to_string(named.param.first);
                         });

}  // namespace
}  // namespace eigenlight
