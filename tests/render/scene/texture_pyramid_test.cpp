#include "render/scene/texture_pyramid.h"

#include <gtest/gtest.h>

namespace eigenlight {
namespace {

Texture make_texture(Extent extent, std::vector<std::uint32_t> texels) {
  Texture texture{"t", extent, {}};
  for (const std::uint32_t t : texels) {
    for (int c = 0; c < 4; ++c) texture.rgba.push_back(static_cast<std::uint8_t>(t >> (8 * c)));
  }
  return texture;
}

constexpr std::uint32_t kWhite = 0xffffffffU;
constexpr std::uint32_t kBlack = 0xff000000U;

TEST(TexturePyramid, TexelCentersReturnLinearTexels) {
  const TexturePyramid t(make_texture({2, 2}, {kBlack, 0xff0000bcU, 0xff00ff00U, kWhite}));
  EXPECT_EQ(t.trilinear({0.25f, 0.25f}, 0.0f), glm::vec3(0.0f));
  EXPECT_NEAR(t.trilinear({0.75f, 0.25f}, 0.0f).x, 0.503f, 1e-3f);  // sRGB 188 is 0.5 in linear
  EXPECT_EQ(t.nearest({0.1f, 0.9f}, 0), glm::vec3(0, 1, 0));
}

TEST(TexturePyramid, TextureRepeatsInBothDirections) {
  const TexturePyramid t(make_texture({2, 2}, {kBlack, kWhite, kWhite, kBlack}));
  for (const float shift : {-3.0f, -1.0f, 1.0f, 7.0f}) {
    EXPECT_EQ(t.nearest({0.3f + shift, 0.1f - shift}, 0), t.nearest({0.3f, 0.1f}, 0));
    EXPECT_NEAR(t.trilinear({0.3f + shift, 0.1f}, 0.0f).x, t.trilinear({0.3f, 0.1f}, 0.0f).x,
                1e-5f);
  }
  // Halfway between the last and the first column.
  EXPECT_NEAR(t.trilinear({0.0f, 0.25f}, 0.0f).x, 0.5f, 1e-5f);
}

TEST(TexturePyramid, LevelsKeepTheMeanOfLinearLight) {
  const TexturePyramid t(
      make_texture({4, 2}, {kBlack, kWhite, kBlack, kWhite, kWhite, kBlack, kWhite, kBlack}));
  EXPECT_EQ(t.levels(), 3);
  for (int level = 1; level < 3; ++level) {
    EXPECT_NEAR(t.nearest({0.3f, 0.6f}, level).x, 0.5f, 0.005f);
  }
  EXPECT_EQ(t.nearest({0.3f, 0.6f}, 99), t.nearest({0.3f, 0.6f}, 2));
  EXPECT_NEAR(t.trilinear({0.125f, 0.25f}, 0.5f).x, 0.25f, 0.005f);  // between black and gray
}

TEST(TexturePyramid, ColorInHolesDoesNotBleed) {
  const std::uint32_t hidden = 0x000000ffU;  // red with an alpha of 0
  const std::uint32_t green = 0xff00ff00U;
  const Texture texture = make_texture({2, 2}, {green, hidden, hidden, green});
  EXPECT_EQ(TexturePyramid(texture).nearest({0, 0}, 1), glm::vec3(0, 1, 0));
  EXPECT_FLOAT_EQ(bilinear_alpha(texture, {0.25f, 0.25f}), 1.0f);
  EXPECT_FLOAT_EQ(bilinear_alpha(texture, {0.75f, 0.25f}), 0.0f);
  EXPECT_FLOAT_EQ(bilinear_alpha(texture, {0.5f, 0.25f}), 0.5f);
}

}  // namespace
}  // namespace eigenlight
