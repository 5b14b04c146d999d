#include "temporal/baselines/point_tracks.h"

#include <gtest/gtest.h>

#include "frame/float_traps.h"
#include "temporal/baselines/basis_history.h"
#include "temporal/baselines/point_taps.h"
#include "tests/reference/taps.h"
#include "tests/support/analytic_source.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

std::vector<Frame> all_frames(const AnalyticOptions& options) {
  AnalyticSource source(options);
  std::vector<Frame> frames;
  for (Frame frame; source.next(frame); frame = {}) frames.push_back(std::move(frame));
  return frames;
}

PointTracks follow(const std::vector<Frame>& frames) {
  std::vector<const Frame*> pointers;
  for (const Frame& frame : frames) pointers.push_back(&frame);
  return {pointers, TapOptions{}};
}

TEST(PointTaps, MatchTheReference) {
  const FloatTrapsOff nan_is_meant;
  const Extent extent{80, 45};
  const Frame before = make_random_frame({.extent = extent, .seed = 4}, 2);
  const Frame now = make_random_frame({.extent = extent, .seed = 4}, 3);
  const PreviousSurface previous{before.camera, before.surface};
  int found = 0;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const reference::Taps wanted = reference::taps(now, previous, {}, {x, y});
      if (wanted.margin < 1e-4) continue;
      const auto& n = now.surface.normal;
      const PointTaps taps =
          point_taps(previous, {},
                     {now.surface.id(x, y),
                      {n[0](x, y), n[1](x, y), n[2](x, y)},
                      glm::vec2(x, y) + glm::vec2(now.motion[0](x, y), now.motion[1](x, y)),
                      now.previous_depth(x, y)});
      for (std::size_t t = 0; t < 4; ++t) {
        EXPECT_NEAR(taps.weight[t], wanted.weight[t], 1e-4) << x << ", " << y << ": " << t;
      }
      found += taps.found() ? 1 : 0;
    }
  }
  EXPECT_GT(found, 1000);
}

TEST(PointTracks, StillSceneHasOnePointPerPixel) {
  AnalyticOptions options{.extent = {20, 11}, .frames = 5};
  options.sky_columns = 4;
  const std::vector<Frame> frames = all_frames(options);
  const PointTracks tracks = follow(frames);
  EXPECT_EQ(tracks.count(), 16u * 11u);
  for (int t = 0; t < 5; ++t) {
    ASSERT_EQ(tracks.samples(t).size(), 16u * 11u);
    for (const TrackSample& sample : tracks.samples(t)) {
      const glm::ivec2 p = sample.corner;
      EXPECT_EQ(sample.weight[0], 1.0f);
      EXPECT_EQ(sample.light.y,
                frames[static_cast<std::size_t>(t)].lights[0].radiance[1](p.x, p.y));
      EXPECT_EQ(sample.track, static_cast<std::uint32_t>(p.y * 16 + p.x - 4));
    }
  }
}

TEST(PointTracks, FollowTheirPointsUnderMotion) {
  AnalyticOptions options{.extent = {48, 27}, .frames = 12, .noise = 0.0f};
  options.slide = {1.3f, -0.6f};
  const std::vector<Frame> frames = all_frames(options);
  const PointTracks tracks = follow(frames);
  // Points of the last frame, seen from the start: light without noise that never changes.
  std::vector<float> last(tracks.count(), -1.0f);
  int compared = 0;
  for (int t = 11; t >= 0; --t) {
    std::uint32_t previous = 0;
    for (const TrackSample& sample : tracks.samples(t)) {
      EXPECT_TRUE(&sample == tracks.samples(t).data() || sample.track > previous);
      previous = sample.track;
      float& light = last[sample.track];
      // Bilinear lookup of a wave of 57 pixels. At the border the taps that are there stand for it.
      const glm::ivec2 p = sample.corner;
      const bool inside = p.x >= 0 && p.y >= 0 && p.x + 1 < 48 && p.y + 1 < 27;
      if (inside && light >= 0.0f) {
        EXPECT_NEAR(sample.light.x, light, 0.01f);
        ++compared;
      }
      light = inside ? sample.light.x : -1.0f;
    }
    // Every pixel is covered.
    Plane<float> coverage(options.extent);
    for (const TrackSample& sample : tracks.samples(t)) {
      for (int i = 0; i < 4; ++i) {
        const float weight = sample.weight[static_cast<std::size_t>(i)];
        if (weight > 0.0f) coverage(sample.corner.x + i % 2, sample.corner.y + i / 2) += weight;
      }
    }
    for (int y = 0; y < 27; ++y) {
      for (int x = 0; x < 48; ++x) EXPECT_GE(coverage(x, y), 0.5f) << t << ": " << x << ", " << y;
    }
    const auto part = tracks.samples(t, 100, 200);
    for (const TrackSample& sample : part) EXPECT_TRUE(sample.track >= 100 && sample.track < 200);
  }
  EXPECT_GT(compared, 8000);
}

TEST(PointTracks, NonFiniteLightIsMarked) {
  std::vector<Frame> frames = all_frames({.extent = {8, 5}, .frames = 2});
  frames[1].lights[0].radiance[2](3, 2) = std::numeric_limits<float>::quiet_NaN();
  const PointTracks tracks = follow(frames);
  EXPECT_FALSE(tracks.samples(1)[2 * 8 + 3].is_usable);
  EXPECT_EQ(tracks.samples(1)[2 * 8 + 3].light, glm::vec3(0.0f));
  EXPECT_TRUE(tracks.samples(0)[2 * 8 + 3].is_usable);
  EXPECT_THROW(PointTracks({}, TapOptions{}), std::invalid_argument);
}

// A history of ones, and of nothing at `hole`.
BasisHistory history_of_ones(const Frame& frame, const HistoryOptions& options, glm::ivec2 hole) {
  BasisHistory history(frame.extent(), 1, options);
  EXPECT_TRUE(history.warp(frame).cut);
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      if (glm::ivec2(x, y) == hole) continue;
      for (int c = 0; c < 3; ++c) history.bases().value(x, y, c, 0) = 1.0f;
      history.bases().age(x, y) = 7.0f;
    }
  }
  history.keep(frame);
  return history;
}

TEST(BasisHistory, DropsTapsWithoutHistory) {
  AnalyticOptions options{.extent = {20, 11}, .frames = 2};
  options.slide = {0.5f, 0.0f};
  const std::vector<Frame> frames = all_frames(options);
  for (const bool drops : {false, true}) {
    BasisHistory history =
        history_of_ones(frames[0], {.drops_empty_taps = drops, .widens = false}, {10, 5});
    EXPECT_FALSE(history.warp(frames[1]).cut);
    // Pixels 9 and 10 lie half over the hole.
    for (const int x : {9, 10}) {
      EXPECT_NEAR(history.bases().value(x, 5, 1, 0), drops ? 1.0f : 0.5f, 1e-5f);
      EXPECT_NEAR(history.bases().age(x, 5), drops ? 7.0f : 3.5f, 1e-4f);
    }
    EXPECT_NEAR(history.bases().value(11, 5, 1, 0), 1.0f, 1e-6f);
  }
}

TEST(BasisHistory, WidensTheSearchAtLostSurfaces) {
  AnalyticOptions options{.extent = {20, 11}, .frames = 2};
  options.slide = {1.5f, 0.0f};
  const std::vector<Frame> frames = all_frames(options);
  for (const bool widens : {false, true}) {
    BasisHistory history =
        history_of_ones(frames[0], {.drops_empty_taps = true, .widens = widens}, {19, 5});
    EXPECT_FALSE(history.warp(frames[1]).cut);
    // Column 19 was at 20.5: its taps are outside; rounded away from the image's last column.
    EXPECT_EQ(history.bases().age(19, 8), 0.0f);
    // Column 18 was at 19.5: column 19 is one of its taps, but in row 5 an empty one, and a pixel
    // whose surface was seen is new there rather than widened.
    EXPECT_NEAR(history.bases().age(18, 8), 7.0f, 1e-4f);
    EXPECT_EQ(history.bases().age(18, 5), 0.0f);
  }
  // A pixel wide gap in the surface under the taps: one of another object.
  std::vector<Frame> gap = all_frames({.extent = {20, 11}, .frames = 2});
  gap[1].is_static = false;
  gap[0].surface.id(6, 6) = 9;
  for (const bool widens : {false, true}) {
    BasisHistory history =
        history_of_ones(gap[0], {.drops_empty_taps = true, .widens = widens}, {5, 6});
    EXPECT_FALSE(history.warp(gap[1]).cut);
    EXPECT_NEAR(history.bases().age(6, 6), widens ? 7.0f : 0.0f, 1e-4f);
    EXPECT_NEAR(history.bases().value(6, 6, 2, 0), widens ? 1.0f : 0.0f, 1e-5f);
  }
}

}  // namespace
}  // namespace eigenlight
