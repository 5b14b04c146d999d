#include "sequences/compare/compare_crops.h"

#include <gtest/gtest.h>

#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

constexpr Extent kSize{12, 8};

// 0 in the left half of the picture, `right` in the right half.
Planes<3> halves(float right) {
  Planes<3> planes = make_planes<3>(kSize);
  for (auto& plane : planes) {
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = kSize.width / 2; x < kSize.width; ++x) plane(x, y) = right;
    }
  }
  return planes;
}

void write(const std::filesystem::path& folder, const std::string& layer, float right) {
  std::filesystem::create_directories(folder);
  const Planes<3> planes = halves(right);
  const ExrChannel channels[] = {{layer + "R", ExrType::kFloat, &planes[0]},
                                 {layer + "G", ExrType::kFloat, &planes[1]},
                                 {layer + "B", ExrType::kFloat, &planes[2]}};
  write_exr(folder / FilePattern(kFramePattern).name(5), channels, {});
}

// Each crop is left of its middle black and right of it as bright as its picture.
TEST(CompareCrops, StandInRowsInTheOrderOfTheContendersAndTheReferenceLast) {
  const TempDir dir;
  ComparePlan plan;
  plan.measured = plan.frames = {4, 5};
  plan.spp = {3};
  plan.extent = kSize;
  plan.contenders = {
      {"a", "noisy", "", {}}, {"b", "", "", ExternalMethod{"b", "", ""}}, {"c", "mean", "", {}}};
  plan.crop = CropPlan{4, 2, {4, 3}, 2};
  ReferenceIdentity identity;
  identity.scene = "room";
  identity.extent = kSize;
  const ReferenceCache references(dir / "cache", identity);
  write(references.path() / "a", "indirect.", 0.9f);
  write(references.path() / "b", "indirect.", 1.1f);
  write(dir / "frames/a", "indirect.", 0.25f);
  write(dir / "frames/b", "", 0.5f);
  write(dir / "frames/c", "indirect.", 0.75f);
  const Plane<std::uint8_t> rows =
      crop_rows(scene_pictures(plan, references, dir / "frames", 1.0f));

  constexpr int kFactor = 72;  // 288 pixels for 4
  constexpr int kWidth = 4 * kFactor, kHeight = 3 * kFactor, kGap = 4;
  ASSERT_EQ(rows.extent(), (Extent{2 * kWidth + kGap, 2 * kHeight + kGap}));
  int previous = 0;
  for (int i = 0; i < 4; ++i) {
    const int x = i % 2 * (kWidth + kGap), y = i / 2 * (kHeight + kGap);
    EXPECT_EQ(*rows.at(x, y), 0) << i;
    EXPECT_EQ(*rows.at(x + kWidth / 2 - 1, y), 0) << i;
    const int right = *rows.at(x + kWidth / 2, y + kHeight - 1);
    EXPECT_GT(right, previous) << i;
    EXPECT_EQ(*rows.at(x + kWidth - 1, y), right) << i;
    previous = right;
  }
  EXPECT_EQ(previous, 255) << "the mean of both references is 1";
  EXPECT_EQ(*rows.at(kWidth + 1, 0), 0) << "the gap is black";
  EXPECT_EQ(crop_names(plan), "a, b, c, reference");
}

}  // namespace
}  // namespace eigenlight
