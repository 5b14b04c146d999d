#include "temporal/baselines/chen2012.h"

#include "frame/random.h"
#include "tests/reference/ccipca.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

constexpr Extent kSmall{32, 20};
constexpr Eigen::Index kSize = 3 * 32 * 20;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Frame t of two lamps, one that pulses and one that swings, each with a pattern of its own.
Planes<3> lamps(int t, float noise) {
  Planes<3> light = make_planes<3>(kSmall);
  const float pulse = 1.0f + 0.3f * std::sin(0.9f * static_cast<float>(t));
  const float swing = 0.4f * std::cos(1.7f * static_cast<float>(t));
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < kSmall.height; ++y) {
      for (int x = 0; x < kSmall.width; ++x) {
        const float first = 1.0f + 0.5f * std::sin(0.2f * static_cast<float>(x));
        const float second = std::cos(0.3f * static_cast<float>(y) + static_cast<float>(c));
        const float random =
            to_unit(hash_key(static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(x + 100 * y),
                             static_cast<std::uint32_t>(c)));
        light[c](x, y) = pulse * first + swing * second + noise * (random - 0.5f);
      }
    }
  }
  return light;
}

template <typename Get>
Eigen::VectorXd flatten(const Get& get) {
  Eigen::VectorXd all(kSize);
  Eigen::Index at = 0;
  for (int y = 0; y < kSmall.height; ++y) {
    for (int x = 0; x < kSmall.width; ++x) {
      for (int c = 0; c < 3; ++c) all[at++] = static_cast<double>(get(x, y, c));
    }
  }
  return all;
}

Eigen::VectorXd flatten_planes(const Planes<3>& planes) {
  return flatten([&](int x, int y, int c) { return planes[static_cast<std::size_t>(c)](x, y); });
}

Eigen::VectorXd flatten_basis(const BasisField& bases, int k) {
  return flatten([&](int x, int y, int c) { return bases.value(x, y, c, k); });
}

double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).norm() / b.norm();
}

double cosine(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::abs(a.dot(b)) / (a.norm() * b.norm());
}

TEST(ImagePca, MatchesTheReference) {
  ImagePca pca(kSmall, 3);
  BasisField bases(kSmall, 3);
  reference::Ccipca twin(kSize, 3);
  Plane<float> weight(kSmall);
  Planes<3> out = make_planes<3>(kSmall);
  for (int t = 1; t <= 7; ++t) {
    for (int y = 0; y < kSmall.height; ++y) {
      for (int x = 0; x < kSmall.width; ++x) {
        weight(x, y) = 1.0f / static_cast<float>(1 + (x + y + t) % 5);
      }
    }
    const Planes<3> light = lamps(t, 0.5f);
    pca.update({light, weight, t}, bases);
    twin.update(flatten_planes(light), flatten([&](int x, int y, int) { return weight(x, y); }));
    const int rank = pca.reconstruct({light, weight, t}, bases, out);
    EXPECT_EQ(rank, std::min(t, 3));
    for (int k = 0; k < rank; ++k) {
      EXPECT_LT(difference(flatten_basis(bases, k), twin.basis(k)), 1e-5) << t << ": " << k;
    }
    if (rank == 3) {
      EXPECT_LT(difference(flatten_planes(out), twin.reconstruct(flatten_planes(light))), 1e-5);
    }
  }
}

TEST(ImagePca, FindsTheLeadingEigenvectors) {
  constexpr int kFrames = 200;
  ImagePca pca(kSmall, 3);
  BasisField bases(kSmall, 3);
  Plane<float> weight(kSmall);
  Eigen::MatrixXd all(kSize, kFrames);
  for (int t = 1; t <= kFrames; ++t) {
    weight.fill(std::min(1.0f, 3.0f / static_cast<float>(t)));
    const Planes<3> light = lamps(t, 0.2f);
    pca.update({light, weight, t}, bases);
    all.col(t - 1) = flatten_planes(light);
  }
  // Eigenvectors of E[u u^T] from the small matrix of inner products between frames.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> batch(all.transpose() * all / kFrames);
  for (int k = 0; k < 2; ++k) {
    const Eigen::VectorXd vector = all * batch.eigenvectors().col(kFrames - 1 - k);
    const Eigen::VectorXd basis = flatten_basis(bases, k);
    EXPECT_GT(cosine(basis, vector), 0.99) << k;
    // Amnesia limits the estimate to some dozens of frames.
    EXPECT_NEAR(basis.norm() / batch.eigenvalues()[kFrames - 1 - k], 1.0, 0.2) << k;
  }
}

TEST(ImagePca, OrthogonalizationKeepsTheSpan) {
  BasisField bases(kSmall, 5);
  for (int k = 0; k < 5; ++k) {
    // The fourth basis is twice the second one, and the fifth is zero.
    const Planes<3> light = lamps(k == 3 ? 1 : k, 1.0f);
    for (int y = 0; y < kSmall.height; ++y) {
      for (int x = 0; x < kSmall.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          const float scale = k == 3 ? 2.0f : k == 4 ? 0.0f : 1.0f;
          bases.value(x, y, c, k) = scale * light[static_cast<std::size_t>(c)](x, y);
        }
      }
    }
  }
  Eigen::MatrixXd old(kSize, 3);
  for (int k = 0; k < 3; ++k) old.col(k) = flatten_basis(bases, k);
  ImagePca(kSmall, 5).orthogonalize(bases);
  EXPECT_EQ(flatten_basis(bases, 0), Eigen::VectorXd(old.col(0)));
  EXPECT_EQ(flatten_basis(bases, 3).norm(), 0.0);
  EXPECT_EQ(flatten_basis(bases, 4).norm(), 0.0);
  Eigen::MatrixXd made(kSize, 3);
  for (int k = 0; k < 3; ++k) made.col(k) = flatten_basis(bases, k).normalized();
  EXPECT_LT((made.transpose() * made - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-5);
  EXPECT_LT((old - made * (made.transpose() * old)).norm() / old.norm(), 1e-5);
}

TEST(ImagePca, LearnsLightAfterDarkness) {
  ImagePca pca(kSmall, 2);
  BasisField bases(kSmall, 2);
  Plane<float> weight(kSmall);
  Planes<3> out = make_planes<3>(kSmall);
  for (int t = 1; t <= 5; ++t) {
    weight.fill(1.0f / static_cast<float>(t));
    Planes<3> light = lamps(1, 0.0f);
    if (t < 4) light = make_planes<3>(kSmall);
    pca.update({light, weight, t}, bases);
    EXPECT_EQ(pca.reconstruct({light, weight, t}, bases, out) > 0, t >= 4);
    EXPECT_NEAR(out[0](3, 4), light[0](3, 4), 1e-5f);
  }
}

TEST(NewPixelFilter, SmoothsMarkedPixelsOnTheirSurface) {
  Frame frame;
  frame.resize(kSmall);
  frame.camera.focal = 32.0f;
  BasisField bases(kSmall, 2);
  Plane<std::uint8_t> smooth(kSmall);
  for (int y = 0; y < kSmall.height; ++y) {
    for (int x = 0; x < kSmall.width; ++x) {
      const bool near = x < 16;
      frame.surface.id(x, y) = 1;
      frame.surface.depth(x, y) = near ? 2.0f : 4.0f;
      frame.surface.normal[2](x, y) = -1.0f;
      bases.age(x, y) = 3.0f;
      bases.value(x, y, 0, 1) = near ? 1.0f : 5.0f;
    }
  }
  // Two marked pixels, one without a value and one with an outlier, and an outlier that is not
  // marked.
  bases.age(15, 8) = 0.0f;
  bases.value(15, 8, 0, 1) = kNan;
  bases.value(16, 12, 0, 1) = 100.0f;
  bases.value(5, 5, 0, 1) = 100.0f;
  smooth(15, 8) = smooth(16, 12) = 1;
  NewPixelFilter(kSmall).process(frame, smooth, bases);
  EXPECT_NEAR(bases.value(15, 8, 0, 1), 1.0f, 1e-5f);
  EXPECT_EQ(bases.age(15, 8), 0.0f);
  EXPECT_GT(bases.value(16, 12, 0, 1), 5.0f);
  EXPECT_LT(bases.value(16, 12, 0, 1), 15.0f);
  EXPECT_EQ(bases.value(5, 5, 0, 1), 100.0f);
}

TEST(Chen2012, ErrorFallsUnderSteadyLight) {
  AnalyticSource source({.frames = 60});
  Chen2012 chen({{64, 36}, 3});
  double first = 0.0, last = 0.0;
  for (int frame = 0; frame < 60; ++frame) {
    const Planes<3>* out = chen.step(source);
    const double error = relative_error(*out, source, chen.frame());
    if (frame == 0) first = error;
    last = error;
    // With w = 1 a basis equals its frame and leaves nothing for other bases, for up to 1 + l
    // frames.
    EXPECT_EQ(chen.report().mean_rank, frame < 3 ? 1 : std::min(frame - 1, 3)) << frame;
    EXPECT_EQ(chen.age()(9, 9), static_cast<float>(frame + 1));
  }
  EXPECT_NEAR(first, 0.25 / 3.0, 0.006);  // the first basis equals the first frame
  EXPECT_LT(last, 0.5 * first);
}

TEST(Chen2012, KeepsLightWithoutNoise) {
  AnalyticOptions options{.frames = 12, .noise = 0.0f};
  options.gain = [](int frame) { return frame % 3 == 0 ? 1.0f : 2.0f; };
  AnalyticSource source(options);
  Chen2012 chen({options.extent, 4});
  for (int frame = 0; frame < 12; ++frame) {
    const Planes<3>* out = chen.step(source);
    EXPECT_LT(relative_error(*out, source, chen.frame()), 1e-10) << frame;
  }
}

TEST(Chen2012, OnlyNewPixelsGetExtraSamples) {
  AnalyticOptions options{.frames = 8};
  options.slide = {2.0f, 0.0f};
  AnalyticSource source(options);
  Chen2012 chen({options.extent, 3});
  const Planes<3>* out = nullptr;
  for (int frame = 0; frame < 8; ++frame) {
    out = chen.step(source);
    EXPECT_EQ(chen.report().new_pixels, frame == 0 ? 64 * 36 : 2 * 36);
    EXPECT_EQ(chen.report().extra_samples, frame == 0 ? 0 : 120 * 2 * 36);
    EXPECT_EQ(chen.report().rays, 3 * 64 * 36 + chen.report().extra_samples);
  }
  // With 123 samples and smoothing, a new pixel is better than an old one.
  double fresh = 0.0, old = 0.0;
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double truth = static_cast<double>(source.truth({x, y}, 0, 7));
      const double error = std::pow(static_cast<double>((*out)[0](x, y)) / truth - 1.0, 2);
      (x >= 62 ? fresh : old) += error / (x >= 62 ? 2 * 36 : 62 * 36);
    }
  }
  EXPECT_LT(fresh, 0.5 * old);
}

TEST(Chen2012, LeavesOutNonFiniteLight) {
  expect_leaves_out_non_finite_light(
      [](Extent extent) {
        return make_denoiser("chen2012", {extent, 3});
      },
      {});
}

TEST(Chen2012, ResumesWithTheSameBits) { expect_resumes("chen2012"); }
TEST(Chen2012, ForgetsHistoryAtCuts) { expect_forgets_at_cuts("chen2012"); }
TEST(Chen2012, SkippingStillFramesChangesNothing) {
  expect_still_frames_change_nothing("chen2012");
}
TEST(Chen2012, ThreadCountDoesNotChangeTheBits) {
  expect_same_bits_on_any_number_of_threads("chen2012");
}
TEST(Chen2012, KeepsConstantLight) { expect_keeps_constant_light("chen2012", 1e-5f); }
TEST(Chen2012, RunsAtAnySize) { expect_runs_at_any_size("chen2012"); }

}  // namespace
}  // namespace eigenlight
