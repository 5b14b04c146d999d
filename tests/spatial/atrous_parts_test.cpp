// Several images of one frame that do not know the same pixels.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "tests/spatial/atrous_scene.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/walls.h"

namespace eigenlight {
namespace {

using test::AtrousScene;

// Passes that need a margin of one block, and of two; with and without light.
const std::vector<AtrousOptions> kCases{
    {.passes = 4, .luminance_sigmas = 5.0f},
    {.passes = 5, .luminance_sigmas = 2.0f},
    {.passes = 6, .luminance_sigmas = std::numeric_limits<float>::infinity()}};

// Walls with light of their own. The second image lacks some pixels, the third wants fewer tiles.
struct ThreeParts {
  explicit ThreeParts(Extent extent)
      : grid(stage_tiles(extent)),
        scenes{AtrousScene(extent), AtrousScene(extent), AtrousScene(extent)},
        wanted{PerTile<std::uint8_t>(grid, 1), PerTile<std::uint8_t>(grid, 1),
               PerTile<std::uint8_t>(grid, 1)} {
    for (AtrousScene& scene : scenes) scene.guides = make_walls(extent, 64);
    for (int x = 0; x < 6; ++x) {
      scenes[1].guides.surface.depth(x, 20) = std::numeric_limits<float>::infinity();
      scenes[1].guides.surface.id(x, 20) = 0;
    }
    for (const int tile : {9, 10, 17}) wanted[2][tile] = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (auto& plane : scenes[i].color) plane(90, 40) += static_cast<float>(i);
    }
  }
  [[nodiscard]] AtrousPart part(std::size_t i) {
    return {scenes[i].guides, wanted[i], scenes[i].color, scenes[i].variance};
  }
  TileGrid grid;
  std::array<AtrousScene, 3> scenes;
  std::array<PerTile<std::uint8_t>, 3> wanted;
};

TEST(Atrous, PartsGetTheBitsThatTheyGetAlone) {
  const Extent extent{330, 100};  // 6 x 7 tiles
  on_every_target([&] {
    for (const AtrousOptions& options : kCases) {
      ThreeParts alone(extent), together(extent);
      for (std::size_t i = 0; i < 3; ++i) {
        Atrous(extent, options).process(std::array{alone.part(i)});
      }
      Atrous atrous(extent, options, 3);
      atrous.process(std::array{together.part(0), together.part(1), together.part(2)});
      EXPECT_EQ(atrous.joined(6) & 2, 0);
      EXPECT_EQ(atrous.joined(41) & 7, 7);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(planes_equal(together.scenes[i].color, alone.scenes[i].color)) << i;
        EXPECT_TRUE(planes_equal(together.scenes[i].variance, alone.scenes[i].variance)) << i;
      }
    }
  });
}

}  // namespace
}  // namespace eigenlight
