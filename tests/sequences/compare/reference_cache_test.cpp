#include "sequences/compare/reference_cache.h"

#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <set>

#include "sequences/files/atomic_file.h"
#include "sequences/runs/flythrough.h"
#include "sequences/runs/open_scene.h"
#include "tests/support/compare.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using Half = ReferenceCache::Half;

class ReferenceCacheTest : public testing::Test {
 protected:
  ReferenceCacheTest() {
    identity_.scene = "cornell";
    identity_.perturb = "none";
    identity_.extent = {32, 18};
    identity_.bounces = 1;
    identity_.spp = 4;
    animation_ = make_flythrough(scene_, Perturbation::kNone, identity_.extent);
  }
  void render(const ReferenceCache& cache, Half half, const std::vector<int>& frames,
              std::size_t stop_after = 100) {
    std::size_t count = 0;
    cache.render(half, frames, {scene_, *animation_},
                 {[&](int) { ++count; }, [&] { return count >= stop_after; }});
  }

  TempDir dir_;
  std::vector<std::string> notes_;
  Scene scene_ = open_scene({"cornell"}, notes_);
  std::unique_ptr<Animation> animation_;
  ReferenceIdentity identity_;
};

TEST_F(ReferenceCacheTest, GoesOnFrameByFrameWithTheSameBits) {
  const ReferenceCache parts(dir_ / "parts", identity_);
  const std::vector<int> frames{4, 5, 6};
  EXPECT_EQ(parts.missing(Half::kA, frames), frames);
  render(parts, Half::kA, frames, 1);
  EXPECT_EQ(parts.missing(Half::kA, frames), (std::vector<int>{5, 6}));
  EXPECT_EQ(parts.missing(Half::kB, frames), frames);
  render(ReferenceCache(dir_ / "parts", identity_), Half::kA, {5, 6});
  const ReferenceCache whole(dir_ / "whole", identity_);
  render(whole, Half::kA, frames);
  for (const int frame : frames) {
    EXPECT_TRUE(planes_equal(parts.load(Half::kA, frame), whole.load(Half::kA, frame)));
  }
}

TEST_F(ReferenceCacheTest, HalvesAndSeedsShareNoSample) {
  std::vector<Planes<3>> images;
  for (const std::uint32_t seed : {0u, 1u}) {
    identity_.seed = seed;
    const ReferenceCache cache(dir_.path(), identity_);
    for (const Half half : ReferenceCache::kHalves) {
      render(cache, half, {0});
      images.push_back(cache.load(half, 0));
    }
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      int lit = 0, equal = 0;
      for (int y = 0; y < 18; ++y) {
        for (int x = 0; x < 32; ++x) {
          if (images[i][0](x, y) == 0.0f) continue;
          ++lit;
          if (images[i][0](x, y) == images[j][0](x, y)) ++equal;
        }
      }
      EXPECT_GT(lit, 100);
      EXPECT_LT(equal, lit / 20) << i << " and " << j;
    }
  }
}

TEST_F(ReferenceCacheTest, AnythingThatChangesTheBitsIsAnotherDirectory) {
  std::set<std::filesystem::path> paths;
  const auto note = [&](auto change) {
    ReferenceIdentity identity = identity_;
    change(identity);
    paths.insert(ReferenceCache(dir_.path(), identity).path());
  };
  note([](ReferenceIdentity&) {});
  note([](ReferenceIdentity&) {});
  note([](ReferenceIdentity& i) { i.scene_hash = 1; });
  note([](ReferenceIdentity& i) { i.perturb = "lights"; });
  note([](ReferenceIdentity& i) { i.extent.width = 33; });
  note([](ReferenceIdentity& i) { i.bounces = 2; });
  note([](ReferenceIdentity& i) { i.spp = 5; });
  note([](ReferenceIdentity& i) { i.seed = 1; });
  note([](ReferenceIdentity& i) { i.renderer = 1; });
  EXPECT_EQ(paths.size(), 8u);
}

TEST_F(ReferenceCacheTest, TheRendererHashSeesWhatItRenders) {
  RenderOptions options;
  options.extent = identity_.extent;
  const std::uint64_t before = renderer_hash({scene_, *animation_}, options);
  EXPECT_EQ(renderer_hash({scene_, *animation_}, options), before);
  options.bounces = 2;
  EXPECT_NE(renderer_hash({scene_, *animation_}, options), before);
  options.bounces = RenderOptions{}.bounces;
  scene_.materials[0].base_color *= 0.5f;
  EXPECT_NE(renderer_hash({scene_, *animation_}, options), before);
}

TEST_F(ReferenceCacheTest, BadFilesAreNamed) {
  const ReferenceCache cache(dir_.path(), identity_);
  const auto message = [&] {
    try {
      (void)cache.load(Half::kB, 7);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message().find("b/frame.0007.exr: no such file"), std::string::npos) << message();
  write_file_atomically(cache.path() / "b/frame.0007.exr", "no picture");
  EXPECT_NE(message().find("b/frame.0007.exr"), std::string::npos) << message();
  std::ofstream(dir_ / "file") << "x";
  EXPECT_THROW(ReferenceCache(dir_ / "file", identity_), std::runtime_error);
}

}  // namespace
}  // namespace eigenlight
