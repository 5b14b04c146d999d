#include "sequences/runs/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace eigenlight {
namespace {

const std::vector<CameraKey> kKeys{{1.0f, {0, 0, 0}, {0, 0, 1}},
                                   {2.0f, {1, 2, 0}, {1, 2, 5}},
                                   {2.5f, {4, 1, 1}, {5, 1, 9}},
                                   {5.0f, {7, 0, 3}, {0, 0, 0}}};

TEST(CameraPath, PassesThroughItsKeys) {
  const CameraPath path(kKeys, 24.0f);
  EXPECT_EQ(path.length(), 96);
  for (const CameraKey& key : kKeys) {
    const CameraPath::View view = path.at(static_cast<int>((key.seconds - 1.0f) * 24.0f));
    EXPECT_LT(distance(view.eye, key.eye), 1e-4f);
    EXPECT_LT(distance(view.look_at, key.look_at), 1e-4f);
  }
}

TEST(CameraPath, TurnsBackAtItsEnds) {
  const CameraPath path(kKeys, 24.0f);
  for (int frame = 0; frame <= path.length(); ++frame) {
    for (const int same : {-frame, frame + path.period(), frame - 3 * path.period()}) {
      EXPECT_EQ(path.at(frame).eye, path.at(same).eye) << frame;
      EXPECT_EQ(path.at(frame).look_at, path.at(same).look_at) << frame;
    }
  }
}

// A straight line at constant speed is reproduced between its inner keys.
TEST(CameraPath, KeepsConstantSpeedOnALine) {
  std::vector<CameraKey> keys;
  for (const float t : {0.0f, 1.0f, 1.5f, 3.0f, 4.0f}) {
    keys.push_back({t, {2.0f * t, 0, 0}, {2.0f * t, 0, 1}});
  }
  const CameraPath path(keys, 24.0f);
  for (int frame = 24; frame <= 72; ++frame) {
    EXPECT_NEAR(path.at(frame).eye.x, 2.0f * static_cast<float>(frame) / 24.0f, 1e-4f);
  }
}

TEST(CameraPath, OneKeyGivesAStaticCamera) {
  const CameraPath path({{3.0f, {1, 2, 3}, {4, 5, 6}}}, 24.0f);
  for (const int frame : {-7, 0, 100}) EXPECT_EQ(path.at(frame).eye, glm::vec3(1, 2, 3));
}

TEST(CameraPath, BadKeysAreErrors) {
  EXPECT_THROW(CameraPath({}, 24.0f), std::invalid_argument);
  EXPECT_THROW(CameraPath({kKeys[1], kKeys[0]}, 24.0f), std::invalid_argument);
  std::vector<CameraKey> broken = kKeys;
  broken[2].eye.y = std::nanf("");
  EXPECT_THROW(CameraPath(broken, 24.0f), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
