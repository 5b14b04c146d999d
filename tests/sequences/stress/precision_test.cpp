// The pipeline in float against its twin in double. `precision_curves` (tests/bench) runs more
// frames.
#include <gtest/gtest.h>

#include "tests/support/precision_run.h"

namespace eigenlight {
namespace {

void expect_near_its_twin(const PrecisionScene& scene) {
  PrecisionRun run(scene);
  for (int frame = 0; frame < scene.frames; ++frame) {
    const double off = run.step();
    EXPECT_GE(off, 0.0) << scene.name << ", frame " << frame;
    EXPECT_LT(off, 1e-3) << scene.name << ", frame " << frame;
  }
}

TEST(Precision, FloatStaysNearDoubleInSteadyLight) {
  for (const char* name : {"cornell", "atrium", "gallery"}) {
    expect_near_its_twin({.name = name, .extent = {48, 27}, .frames = 24});
  }
}

TEST(Precision, FloatStaysNearDoubleInMovingLight) {
  expect_near_its_twin({"atrium", Perturbation::kLights, {48, 27}, 24});
}

}  // namespace
}  // namespace eigenlight
