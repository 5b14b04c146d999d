// The pictures that `compare --paper xu2024` filters, and what it makes of them.
#include "sequences/lab/paper_xu2024.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sequences/lab/paper_reruns.h"
#include "sequences/lab/paper_xu2024_uses.h"
#include "sequences/metrics/similarity.h"

namespace eigenlight {
namespace {

constexpr Extent kSize{48, 27};

Frame cornell_frame() {
  const PaperScene scene("cornell", Perturbation::kNone, kSize, PaperScene::View::kFlight);
  return std::move(scene.render(1, {4}).front());
}

template <typename Edge>
void expect_picture(const PyramidUse<Edge>& use) {
  float low = 1.0f, high = 0.0f;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (!(use.weight(x, y) > 0.0f)) continue;
      EXPECT_TRUE(use.edge.exists(use.attributes.at(x, y))) << x << ", " << y;
      low = std::min(low, use.signal[1](x, y)), high = std::max(high, use.signal[1](x, y));
    }
  }
  EXPECT_GE(low, 0.0f);
  EXPECT_GT(high, low + 0.05f);
  EXPECT_LE(high, 4.0f);  // x / (1 + L) of a color of one channel
}

TEST(PaperXu2024, UsesHavePicturesAndAttributes) {
  const Frame frame = cornell_frame();
  expect_picture(diffuse_use(frame, frame.lights[0].radiance, 1.0f));
  expect_picture(reflection_use(frame));
  expect_picture(depth_of_field_use(frame));
  const auto reflection = reflection_use(frame);
  float least = 1.0f, most = 0.0f;
  for (int i = 0; i < kSize.width; ++i) {
    const float roughness = reflection.attributes.at(i, kSize.height - 3)[4];
    least = std::min(least, roughness), most = std::max(most, roughness);
  }
  EXPECT_LT(least, most);  // the floor is checkered
}

TEST(PaperXu2024, CompressedLightOfLuminanceOneIsHalved) {
  Planes<3> light = make_planes<3>({2, 1});
  Plane<float> mask({2, 1});
  mask(0, 0) = 1.0f;
  for (Plane<float>& plane : light) plane.fill(1.0f);
  light[0](0, 0) = 2.0f, light[2](0, 0) = 0.0f;
  compress(mask, light);
  EXPECT_FLOAT_EQ(light[0](0, 0), 1.0f);
  EXPECT_FLOAT_EQ(light[1](0, 0), 0.5f);
  EXPECT_FLOAT_EQ(light[1](1, 0), 1.0f);  // not in the mask
}

// A flat depth faces the viewer; a ramp does not.
TEST(PaperXu2024, ParticlesAreLitByTheSlopeOfTheirDepth) {
  PyramidUse<ParticleEdge> use({}, {8, 8});
  use.weight.fill(1.0f);
  Planes<3> depth = make_planes<3>({8, 8});
  for (Plane<float>& plane : depth) plane.fill(5.0f);
  const float flat = lit_particles(use, depth)[0](4, 4);
  EXPECT_NEAR(flat, 0.1f + 0.9f * 0.82f, 1e-5f);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) depth[0](x, y) = 5.0f - 0.5f * static_cast<float>(x);
  }
  EXPECT_LT(lit_particles(use, depth)[0](4, 4), flat - 0.1f);
}

// Both are the same sum where nothing stops: the kernel is then a product.
TEST(PaperXu2024, SeparablePassesAreExactWithoutEdges) {
  PyramidUse<ColorEdge> use({.blur_radius = 5.0f}, {31, 23});
  use.weight.fill(1.0f);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 31; ++x)
      use.signal[0](x, y) = static_cast<float>((x * 7 + y * 5) % 11) / 11.0f;
  }
  Planes<3> brute = make_planes<3>({31, 23}), lines = make_planes<3>({31, 23});
  bilateral_filter(use.edge, use.inputs(), brute);
  separable_bilateral_filter(use.edge, use.inputs(), lines);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 31; ++x) ASSERT_NEAR(lines[0](x, y), brute[0](x, y), 1e-5f);
  }
}

TEST(PaperXu2024, LikenessCountsPixelsWithWeight) {
  Planes<3> a = make_planes<3>({16, 16}), b = make_planes<3>({16, 16});
  Plane<float> weight({16, 16});
  for (std::size_t c = 0; c < 3; ++c) a[c].fill(0.6f), b[c].fill(0.5f);
  EXPECT_EQ(similarity(a, b, weight).psnr, 0.0);
  weight.fill(1.0f);
  EXPECT_NEAR(similarity(a, b, weight).psnr, 20.0, 1e-4);  // -10 log10 0.1^2
  a[1](3, 3) = 0.0f;
  weight(3, 3) = 0.0f;
  EXPECT_NEAR(similarity(a, b, weight).psnr, 20.0, 1e-4);
  EXPECT_TRUE(std::isinf(similarity(a, a, weight).psnr));
  EXPECT_NEAR(similarity(a, a, weight).ssim, 1.0, 1e-12);
}

// The whole at the size of a stamp: every claim has a figure, and every table its rows.
TEST(PaperXu2024, ReportHasAFigureForEachClaim) {
  std::vector<std::string> steps;
  const PaperRun run{
      {48, 27}, {0, 1, 2, 3, 4, 5, 6, 7}, [&](const std::string& what) { steps.push_back(what); }};
  const Paper paper = xu2024();
  const PaperReport report = paper.rerun(run);
  ASSERT_EQ(report.sections.size(), 4u);
  EXPECT_GE(steps.size(), 8u);
  ASSERT_EQ(report.claims.size(), 14u);
  for (const PaperClaim& claim : report.claims) {
    EXPECT_FALSE(claim.ours.empty()) << claim.claim;
    EXPECT_THAT(claim.ours, testing::Not(testing::HasSubstr("nan"))) << claim.claim;
  }
  EXPECT_EQ(report.sections[0].tables[0].rows.size(), 4u);
  EXPECT_EQ(report.sections[1].tables[0].rows.size(), 3u);
  EXPECT_EQ(report.sections[2].tables[0].rows.size(), 7u);
  EXPECT_EQ(report.sections[3].plots[0].series[0].points.size(), 7u);
  for (const TableRow& row : report.sections[0].tables[0].rows) {
    EXPECT_GT(std::get<double>(row.cells[1]), 15.0) << row.name;
  }
  EXPECT_NO_THROW((void)to_html(paper_page(paper, run, report)));
}

}  // namespace
}  // namespace eigenlight
