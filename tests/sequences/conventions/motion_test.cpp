#include "sequences/conventions/motion.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sequences/conventions/background.h"
#include "sequences/conventions/depth_reading.h"
#include "tests/sequences/conventions/analytic_shot.h"

namespace eigenlight {
namespace {

Plane<float> depth_of(const RawGuides& guides) {
  Plane<float> depth;
  apply_depth(guides.depth, {}, nullptr, depth);
  return depth;
}

TEST(ApplyMotion, ScalesBackwardVectors) {
  const AnalyticShot shot;
  RawGuides now = shot.frame(3);
  now.motion[0](5, 6) = std::numeric_limits<float>::infinity();
  Planes<2> motion;
  apply_motion(now, nullptr, {0, 2.0, -3.0, true}, motion);
  EXPECT_FLOAT_EQ(motion[0](40, 50), 2.0f * now.motion[0](40, 50));
  EXPECT_FLOAT_EQ(motion[1](40, 50), -3.0f * now.motion[1](40, 50));
  EXPECT_TRUE(std::isnan(motion[0](5, 6)));
  EXPECT_TRUE(std::isnan(motion[1](5, 6)));
}

TEST(ApplyMotion, BringsForwardVectorsToWhereTheyLand) {
  const AnalyticShot shot;
  const RawGuides now = shot.frame(4), before = shot.frame(3);
  Planes<2> motion;
  // The second pair of the frame before leads to this one.
  apply_motion(now, &before, {1, 1.0, 1.0, false}, motion);
  std::vector<float> errors;
  int holes = 0;
  for (int y = 0; y < shot.extent.height; ++y) {
    for (int x = 0; x < shot.extent.width; ++x) {
      if (!std::isfinite(motion[0](x, y))) {
        ++holes;
        continue;
      }
      errors.push_back(
          std::hypot(motion[0](x, y) - now.motion[0](x, y), motion[1](x, y) - now.motion[1](x, y)));
    }
  }
  std::sort(errors.begin(), errors.end());
  // Holes are what was hidden, or outside.
  EXPECT_LT(holes, 0.06 * static_cast<double>(shot.extent.pixels()));
  EXPECT_LT(errors[errors.size() / 2], 0.02f);
  EXPECT_LT(errors[errors.size() * 97 / 100], 0.15f);
}

TEST(ApplyMotion, LetsTheNearestWin) {
  RawGuides now, before;
  const Extent extent{8, 1};
  now.depth = Plane<float>(extent);
  before.depth = Plane<float>(extent);
  for (int c = 0; c < 2; ++c) before.motion.emplace_back(extent);
  before.depth.fill(10.0f);
  before.depth(1, 0) = 2.0f;  // moves by three pixels, in front of the others
  before.motion[0](1, 0) = -3.0f;
  Planes<2> motion;
  apply_motion(now, &before, {0, 1.0, 1.0, false}, motion);
  EXPECT_EQ(motion[0](4, 0), -3.0f);
  EXPECT_EQ(motion[0](3, 0), 0.0f);
  EXPECT_TRUE(std::isnan(motion[0](1, 0)));  // what it leaves behind
  before.depth(1, 0) = 20.0f;                // behind the others
  apply_motion(now, &before, {0, 1.0, 1.0, false}, motion);
  EXPECT_EQ(motion[0](4, 0), 0.0f);
}

TEST(ApplyMotion, KnowsNothingWithoutTheFrameBeforeAndThrowsWithoutChannels) {
  const AnalyticShot shot;
  RawGuides now = shot.frame(3);
  Planes<2> motion;
  apply_motion(now, nullptr, {0, 1.0, 1.0, false}, motion);
  EXPECT_TRUE(std::isnan(motion[0](9, 9)));
  now.motion.resize(2);
  EXPECT_THROW(apply_motion(now, nullptr, {1, 1.0, 1.0, true}, motion), std::invalid_argument);
}

TEST(MotionFromCameras, IsThatOfStaticPoints) {
  AnalyticShot shot;
  shot.has_back_wall = false;
  const RawGuides now = shot.frame(4);
  const Camera before = shot.camera(3);
  Planes<2> motion;
  Plane<float> previous;
  motion_from_cameras(depth_of(now), *now.camera, before, motion, previous);
  int compared = 0, sky = 0;
  for (int y = 0; y < shot.extent.height; ++y) {
    for (int x = 0; x < shot.extent.width; ++x) {
      const AnalyticShot::Hit hit = shot.hit(4, x, y);
      if (hit.moves) continue;
      if (std::isfinite(hit.depth)) {
        ++compared;
        EXPECT_NEAR(motion[0](x, y), now.motion[0](x, y), 2e-3f);
        EXPECT_NEAR(motion[1](x, y), now.motion[1](x, y), 2e-3f);
        EXPECT_NEAR(previous(x, y), before.to_view(hit.position).z, 1e-4f);
      } else {
        ++sky;
        EXPECT_FALSE(std::isfinite(previous(x, y)));
        // A point far away: only the turn counts.
        const glm::vec2 pixel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const glm::vec3 far = now.camera->to_world(now.camera->pixel_to_view(pixel) * 1e6f);
        const glm::vec2 there = before.view_to_pixel(before.to_view(far)) - pixel;
        EXPECT_NEAR(motion[0](x, y), there.x, 0.02f);
        EXPECT_NEAR(motion[1](x, y), there.y, 0.02f);
        EXPECT_GT(std::hypot(motion[0](x, y), motion[1](x, y)), 0.3f);
      }
    }
  }
  EXPECT_GT(compared, 3000);
  EXPECT_GT(sky, 1000);
}

TEST(MotionFromCameras, HasNoMotionForWhatWasBehindTheCamera) {
  const Extent extent{20, 10};
  const Camera now = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
  const Camera before = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60.0f, extent);
  Plane<float> depth(extent), previous;
  depth.fill(3.0f);
  Planes<2> motion;
  motion_from_cameras(depth, now, before, motion, previous);
  EXPECT_TRUE(std::isnan(motion[0](4, 4)));
  EXPECT_EQ(previous(4, 4), 0.0f);
}

TEST(PreviousDepth, IsThatOfStaticAndOfMovingPoints) {
  const AnalyticShot shot;
  const RawGuides now = shot.frame(4), before = shot.frame(3);
  Planes<2> motion;
  apply_motion(now, &before, {0, 1.0, 1.0, true}, motion);
  const CameraPair cameras{*now.camera, *before.camera};
  for (const CameraPair* pair : {&cameras, static_cast<const CameraPair*>(nullptr)}) {
    Plane<float> previous;
    previous_depth_of(motion, depth_of(now), depth_of(before), pair, previous);
    std::vector<float> resting, moving;
    for (int y = 2; y < shot.extent.height - 2; ++y) {
      for (int x = 2; x < shot.extent.width - 2; ++x) {
        const AnalyticShot::Hit hit = shot.hit(4, x, y);
        const glm::vec3 shift =
            hit.moves ? shot.moving_center(3) - shot.moving_center(4) : glm::vec3(0.0f);
        const float truth = before.camera->to_view(hit.position + shift).z;
        (hit.moves ? moving : resting).push_back(std::abs(previous(x, y) / truth - 1.0f));
      }
    }
    ASSERT_GT(moving.size(), 200u);
    std::sort(resting.begin(), resting.end());
    std::sort(moving.begin(), moving.end());
    EXPECT_LT(resting[resting.size() * 9 / 10], pair != nullptr ? 1e-5f : 0.02f);
    EXPECT_LT(moving[moving.size() * 9 / 10], 0.02f);
  }
}

TEST(PreviousDepth, IsZeroOutsideAndInfiniteInTheSky) {
  const Extent extent{6, 4};
  Plane<float> now(extent), before(extent), previous;
  now.fill(2.0f);
  before.fill(2.5f);
  now(1, 1) = std::numeric_limits<float>::infinity();
  Planes<2> motion = make_planes<2>(extent);
  motion[0](2, 2) = 9.0f;
  motion[0](3, 3) = std::numeric_limits<float>::quiet_NaN();
  previous_depth_of(motion, now, before, nullptr, previous);
  EXPECT_EQ(previous(0, 0), 2.5f);
  EXPECT_EQ(previous(1, 1), std::numeric_limits<float>::infinity());
  EXPECT_EQ(previous(2, 2), 0.0f);
  EXPECT_EQ(previous(3, 3), 0.0f);
  EXPECT_THROW(previous_depth_of(motion, now, Plane<float>({3, 3}), nullptr, previous),
               std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
