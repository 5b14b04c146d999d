// Edges of shadows in antialiased pictures.
#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

/// A floor, half of it in the shadow of a black plate, under a sun without width whose shadow's
/// edge is slanted in the picture. No light is indirect.
Scene shadowed_floor() {
  Scene scene;
  const auto gray = test::add_material(scene, glm::vec3(0.5f));
  test::add_floor(scene, gray, 5.0f);
  const auto black = test::add_material(scene, glm::vec3(0.0f));
  test::add_quad(scene, black, {glm::vec3(-3, 2, -9), glm::vec3(9, 0, 0), glm::vec3(6, 0, 18)});
  scene.lights.suns = {{glm::vec3(0, 1, 0), glm::vec3(3.0f), 0.0f}};
  return scene;
}

// With denoised direct light nothing is path-traced: a shadow's edge shows coverage, and the rest
// keeps its color.
TEST(ShadowEdge, LookupSmoothsEdgesOfShadowsOfDenoisedLight) {
  constexpr Extent kSize{48, 32};
  const Scene scene = shadowed_floor();
  const Camera camera = test::camera_down(kSize);
  const test::FunctionAnimation animation = test::still(scene, camera);
  LiveSource source(scene, animation, test::render_options(kSize, 1), {0});
  Frame frame;
  ASSERT_TRUE(source.next(frame));
  Planes<3> smooth, truth;
  (void)source.picture({AntialiasMode::kSupersample, 256}, frame, frame.lights[0].radiance, truth);
  const PictureStats stats = source.picture({AntialiasMode::kLookup, 1}, frame,
                                            frame.lights[0].radiance, smooth, &frame.direct);
  EXPECT_EQ(stats.unmatched, 0);
  double hard_error = 0.0, error = 0.0;
  int between = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const auto wanted = static_cast<double>(truth[0](x, y));
      const double hard = 0.5 * static_cast<double>(frame.direct[0](x, y));
      const auto value = static_cast<double>(smooth[0](x, y));
      hard_error += (hard - wanted) * (hard - wanted);
      error += (value - wanted) * (value - wanted);
      between += value > 0.05 && value < 0.4;
    }
  }
  EXPECT_GT(between, 20);
  EXPECT_LT(error, 0.1 * hard_error);
}

}  // namespace
}  // namespace eigenlight
