#include "temporal/baselines/meyer2006.h"

#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

PointTracks follow(const std::vector<Frame>& frames) {
  std::vector<const Frame*> pointers;
  for (const Frame& frame : frames) pointers.push_back(&frame);
  return {pointers, TapOptions{}};
}

std::vector<Frame> all_frames(const AnalyticOptions& options) {
  AnalyticSource source(options);
  std::vector<Frame> frames;
  for (Frame frame; source.next(frame); frame = {}) frames.push_back(std::move(frame));
  return frames;
}

TEST(TrackPca, MatchesTheSvdWithoutMissingPoints) {
  AnalyticOptions options{.extent = {24, 16}, .frames = 10, .noise = 0.3f};
  options.gain = [](int frame) { return 1.0f + 0.5f * std::sin(0.8f * static_cast<float>(frame)); };
  const std::vector<Frame> frames = all_frames(options);
  const PointTracks tracks = follow(frames);
  const TrackPca pca(tracks, {.bases = 3, .frames_per_basis = 1});

  Eigen::MatrixXd all(3 * 24 * 16, 10);
  for (Eigen::Index t = 0; t < 10; ++t) {
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
      const int pixel = static_cast<int>(i / 3);
      const auto& u =
          frames[static_cast<std::size_t>(t)].lights[0].radiance[static_cast<std::size_t>(i % 3)];
      all(i, t) = static_cast<double>(u(pixel % 24, pixel / 24));
    }
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::MatrixXd wanted = svd.matrixU().leftCols(3) *
                                 svd.singularValues().head(3).asDiagonal() *
                                 svd.matrixV().leftCols(3).transpose();
  ASSERT_EQ(pca.bases(), 3);
  for (std::uint32_t track = 0; track < tracks.count(); ++track) {
    for (int t = 0; t < 10; ++t) {
      const glm::vec3 light = pca.light(track, t);
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(light[c], wanted(3 * static_cast<Eigen::Index>(track) + c, t), 1e-4);
      }
    }
  }
}

TEST(TrackPca, RecoversAGainFromPartiallyVisiblePoints) {
  // Under a moving camera no point is in all frames; light is a pattern times a gain: rank 1.
  AnalyticOptions options{.extent = {48, 27}, .frames = 14, .noise = 0.0f};
  options.slide = {3.0f, 0.0f};
  options.gain = [](int frame) { return frame % 3 == 0 ? 0.5f : 2.0f; };
  const std::vector<Frame> frames = all_frames(options);
  const PointTracks tracks = follow(frames);
  const TrackPca pca(tracks, {.bases = 1, .sweeps = 20});
  double first = 0.0;
  for (int t = 0; t < 14; ++t) {
    const double gain = pca.weights()(t, 0) / static_cast<double>(options.gain(t));
    if (t == 0) first = gain;
    EXPECT_NEAR(gain / first, 1.0, 1e-3) << t;
    for (const TrackSample& sample : tracks.samples(t)) {
      ASSERT_NEAR(pca.light(sample.track, t).x, sample.light.x, 1e-2f * sample.light.x) << t;
    }
  }
}

TEST(TrackPca, PointsOfFewFramesHaveFewBases) {
  AnalyticOptions options{.extent = {32, 18}, .frames = 12};
  options.slide = {2.0f, 0.0f};
  const std::vector<Frame> frames = all_frames(options);
  const PointTracks tracks = follow(frames);
  const TrackPca pca(tracks, {.bases = 3, .frames_per_basis = 4});
  bool few = false, many = false;
  for (std::uint32_t track = 0; track < tracks.count(); ++track) {
    const int seen = pca.seen(track);
    EXPECT_EQ(pca.bases_of(track), std::clamp(seen / 4, 1, 3));
    few = few || seen < 4;
    many = many || seen == 12;
  }
  EXPECT_TRUE(few && many);
  EXPECT_THROW(TrackPca(tracks, {.bases = 9}), std::invalid_argument);
  EXPECT_THROW(TrackPca(tracks, {.frames_per_basis = 0}), std::invalid_argument);
  EXPECT_THROW(TrackPca(tracks, {.sweeps = -1}), std::invalid_argument);
}

TEST(Meyer2006, AveragesSteadyLightOverTheSequence) {
  AnalyticOptions options{.frames = 30};
  AnalyticSource source(options);
  Meyer2006 meyer({options.extent, 1});
  double error = 0.0;
  for (int frame = 0; frame < 30; ++frame) {
    const Planes<3>* out = meyer.step(source);
    ASSERT_NE(out, nullptr);
    EXPECT_EQ(meyer.frame().index, frame);
    EXPECT_EQ(meyer.report().frame, frame);
    EXPECT_EQ(meyer.report().cut, frame == 0);
    EXPECT_EQ(meyer.age()(9, 9), 30.0f);
    EXPECT_EQ(meyer.report().surface_pixels, 64 * 36);
    error = relative_error(*out, source, meyer.frame());
  }
  // One basis: the mean of 30 frames, from the first on.
  EXPECT_NEAR(error * 30.0 / (0.25 / 3.0), 1.0, 0.1);
  EXPECT_EQ(meyer.step(source), nullptr);
}

TEST(Meyer2006, FollowsLightInTheSpanOfItsBases) {
  AnalyticOptions options{.extent = {80, 45}, .frames = 24};
  options.gain = [](int frame) { return frame % 2 == 0 ? 1.0f : 3.0f; };
  AnalyticSource source(options);
  Meyer2006 meyer({options.extent, 1});
  while (const Planes<3>* out = meyer.step(source)) {
    // One of 24 directions of noise stays, most of it that of the bright half.
    EXPECT_LT(relative_error(*out, source, meyer.frame()), 2.0 / 24.0 * 0.25 / 3.0);
  }
}

TEST(Meyer2006, LeavesOutNonFiniteLight) {
  AnalyticOptions options{.frames = 8, .noise = 0.0f};
  options.slide = {0.5f, 0.5f};
  options.edit = [](Frame& frame) {
    if (frame.index == 0) frame.lights[0].radiance[1](30, 20) = kNan;
    if (frame.index == 3)
      frame.lights[0].radiance[2](40, 10) = std::numeric_limits<float>::infinity();
  };
  AnalyticSource source(options);
  Meyer2006 meyer({options.extent, 3});
  for (int frame = 0; frame < 8; ++frame) {
    const Planes<3>* out = meyer.step(source);
    EXPECT_EQ(meyer.report().non_finite_pixels, frame == 0 || frame == 3 ? 1 : 0);
    EXPECT_TRUE(all_finite(*out));
    EXPECT_LT(relative_error(*out, source, meyer.frame()), 1e-3) << frame;
  }
  // Only the pixel that is never finite is 0.
  AnalyticOptions never{.frames = 3, .noise = 0.0f};
  never.edit = [](Frame& frame) { frame.lights[0].radiance[0](5, 5) = kNan; };
  AnalyticSource dark(never);
  Meyer2006 other({never.extent, 3});
  const Planes<3>* out = other.step(dark);
  EXPECT_EQ((*out)[0](5, 5), 0.0f);
  EXPECT_EQ(other.age()(5, 5), 0.0f);
  EXPECT_NEAR((*out)[0](6, 5), dark.truth({6, 5}, 0, 0), 1e-4f);
}

TEST(Meyer2006, KeepsConstantLight) { expect_keeps_constant_light("meyer2006", 1e-5f); }

TEST(Meyer2006, RejectsMoreFramesThanItHolds) {
  AnalyticSource source({.frames = 4});
  Meyer2006 meyer({{64, 36}, 1}, {.most_bytes = 3 * 64 * 36 * 150});
  try {
    (void)meyer.step(source);
    FAIL() << "four frames where three fit";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("4 frames of 64x36"), std::string::npos);
  }
  AnalyticSource shorter({.frames = 3});
  Meyer2006 fits({{64, 36}, 1}, {.most_bytes = 3 * 64 * 36 * 150});
  EXPECT_NE(fits.step(shorter), nullptr);
}

// A sequence is read whole, so after a restart the source begins with the frame that comes next.
TEST(Meyer2006, ResumesWithTheSameBits) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 9};
  options.slide = {1.3f, -0.4f};
  const Planes<3> straight = last_picture("meyer2006", options);
  AnalyticSource source(options);
  Meyer2006 first({options.extent, 3});
  for (int i = 0; i < 5; ++i) ASSERT_NE(first.step(source), nullptr);
  StateWriter state;
  first.save(state);
  const std::string_view bytes(state.bytes().data(), state.bytes().size());

  AnalyticOptions rest = options;
  rest.first_frame = 5;
  rest.frames = 4;
  AnalyticSource remaining(rest);
  Meyer2006 second({options.extent, 3});
  StateReader reader(bytes);
  second.load(reader);
  reader.finish();
  const Planes<3>* out = nullptr;
  for (int i = 5; i < 9; ++i) {
    out = second.step(remaining);
    ASSERT_NE(out, nullptr);
    EXPECT_EQ(second.frame().index, i);
    EXPECT_FALSE(second.report().cut);
  }
  EXPECT_TRUE(same_bits(*out, straight));
  EXPECT_EQ(second.step(remaining), nullptr);

  Meyer2006 astray({options.extent, 3});
  StateReader again(bytes);
  astray.load(again);
  AnalyticSource other(options);
  EXPECT_THROW((void)astray.step(other), std::runtime_error);
  StateReader narrow(bytes);
  EXPECT_THROW(Meyer2006({{64, 17}, 3}).load(narrow), std::runtime_error);
  StateReader fewer(bytes);
  EXPECT_THROW(Meyer2006({options.extent, 2}).load(fewer), std::runtime_error);
}

TEST(Meyer2006, ForgetsHistoryAtCuts) { expect_forgets_at_cuts("meyer2006"); }
TEST(Meyer2006, SkippingStillFramesChangesNothing) {
  expect_still_frames_change_nothing("meyer2006");
}
TEST(Meyer2006, ThreadCountDoesNotChangeTheBits) {
  expect_same_bits_on_any_number_of_threads("meyer2006");
}
TEST(Meyer2006, RunsAtAnySize) { expect_runs_at_any_size("meyer2006"); }

}  // namespace
}  // namespace eigenlight
