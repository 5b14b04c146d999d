// Frames with several layers of light, and frames in a caller's memory.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "frame/memory_source.h"
#include "temporal/eigen/eigen_denoiser.h"
#include "tests/support/analytic_source.h"
#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

AnalyticOptions moving() {
  AnalyticOptions options{.extent = {150, 70}, .frames = 6};
  options.slide = {0.7f, 0.3f};
  options.sky_columns = 40;
  options.light = [](glm::vec2 at, int frame) {
    return 1.0f + 0.5f * std::sin(0.05f * at.x + 0.7f * static_cast<float>(frame));
  };
  return options;
}

Planes<3> copy_of(const Planes<3>& planes) {
  Planes<3> copy;
  for (std::size_t c = 0; c < 3; ++c) copy[c] = planes[c].clone();
  return copy;
}

std::vector<Planes<3>> run_one_layer(const AnalyticOptions& options) {
  AnalyticSource source(options);
  EigenDenoiser denoiser({options.extent, 3});
  std::vector<Planes<3>> pictures;
  while (const Planes<3>* out = denoiser.step(source)) pictures.push_back(copy_of(*out));
  return pictures;
}

void repeat_first_layer(Frame& frame, std::size_t layers) {
  frame.lights.resize(layers);
  for (std::size_t i = 1; i < layers; ++i) {
    frame.lights[i].radiance = copy_of(frame.lights[0].radiance);
  }
}

TEST(LightLayers, EqualLayersGiveThePictureOfOne) {
  AnalyticOptions options = moving();
  const std::vector<Planes<3>> wanted = run_one_layer(options);
  for (const int layers : {3, Atrous::kMostImages + 2}) {
    options.edit = [&](Frame& frame) {
      repeat_first_layer(frame, static_cast<std::size_t>(layers));
    };
    AnalyticSource source(options);
    EigenDenoiser denoiser({.extent = options.extent, .layers = layers});
    std::int64_t extra = 0;
    for (const Planes<3>& picture : wanted) {
      ASSERT_NE(denoiser.step(source), nullptr);
      extra += denoiser.report().extra_samples;
      for (int layer = 0; layer < layers; ++layer) {
        ASSERT_TRUE(test::same_bits(denoiser.output(layer), picture)) << "layer " << layer;
      }
    }
    EXPECT_GT(extra, 0);
  }
}

TEST(LightLayers, EachLayerFollowsItsOwnLight) {
  AnalyticOptions options = moving();
  options.noise = 0.0f;
  options.edit = [](Frame& frame) {
    repeat_first_layer(frame, 2);
    // The second layer goes out in frame 3.
    for (auto& plane : frame.lights[1].radiance) plane.fill(frame.index < 3 ? 0.25f : 0.0f);
  };
  AnalyticSource source(options);
  EigenOptions tuning;
  tuning.budget.share = 0.0;  // extra samples would be those of the first layer
  EigenDenoiser denoiser({.extent = options.extent, .layers = 2}, tuning);
  while (denoiser.step(source) != nullptr) {
    const float wanted = denoiser.frame().index < 3 ? 0.25f : 0.0f;
    EXPECT_NEAR(denoiser.output(1)[0](100, 30), wanted, 1e-6f) << denoiser.frame().index;
    EXPECT_GT(denoiser.output(0)[0](100, 30), 0.05f);
  }
}

TEST(LightLayers, RejectsFramesWithAnotherNumberOfLayers) {
  AnalyticSource source(moving());
  EigenDenoiser denoiser({.extent = moving().extent, .layers = 2});
  EXPECT_THROW((void)denoiser.step(source), std::invalid_argument);
  EXPECT_THROW(EigenDenoiser({.extent = {8, 8}, .layers = 0}), std::invalid_argument);
  EXPECT_THROW(EigenDenoiser({.extent = {8, 8}, .layers = kMaxLights + 1}), std::invalid_argument);
}

TEST(LightLayers, StateRestoresEveryLayer) {
  AnalyticOptions options = moving();
  options.edit = [](Frame& frame) {
    repeat_first_layer(frame, 2);
    for (auto& plane : frame.lights[1].radiance) plane.fill(0.5f);
  };
  AnalyticSource source(options);
  const DenoiserOptions two{.extent = options.extent, .layers = 2};
  EigenDenoiser denoiser(two), later(two);
  for (int i = 0; i < 3; ++i) ASSERT_NE(denoiser.step(source), nullptr);
  StateWriter out;
  denoiser.save(out);
  const std::string_view bytes(out.bytes().data(), out.bytes().size());
  StateReader in(bytes);
  later.load(in);
  in.finish();
  AnalyticOptions rest = options;
  rest.first_frame = 3, rest.frames = 1;
  AnalyticSource same(rest);
  ASSERT_NE(denoiser.step(source), nullptr);
  ASSERT_NE(later.step(same), nullptr);
  for (int layer = 0; layer < 2; ++layer) {
    EXPECT_TRUE(test::same_bits(denoiser.output(layer), later.output(layer))) << layer;
  }
  EigenDenoiser one({options.extent, 3});
  StateReader again(bytes);
  EXPECT_THROW(one.load(again), std::runtime_error);
}

// Values of a plane in unaligned rows from the bottom up, with NaN (or 9) between the rows.
template <typename T>
class ForeignCopy {
 public:
  explicit ForeignCopy(const Plane<T>& plane)
      : extent_(plane.extent()),
        memory_(
            static_cast<std::size_t>(kStride * plane.height() + 1),
            std::numeric_limits<T>::has_quiet_NaN ? std::numeric_limits<T>::quiet_NaN() : T{9}) {
    for (int y = 0; y < extent_.height; ++y) std::copy_n(plane.row(y), extent_.width, row(y));
  }
  [[nodiscard]] Plane<T> view() {
    return Plane<T>::view(row(0), extent_, -kStride * static_cast<std::ptrdiff_t>(sizeof(T)));
  }

 private:
  static constexpr int kStride = 163;
  [[nodiscard]] T* row(int y) { return memory_.data() + 1 + kStride * (extent_.height - 1 - y); }

  Extent extent_;
  std::vector<T> memory_;
};

struct ForeignFrame {
  explicit ForeignFrame(const Frame& frame) {
    copy_frame(frame, own);
    const auto show = [&](auto& plane, auto& kept) {
      kept.emplace_back(plane);
      plane = kept.back().view();
    };
    floats.reserve(16);
    for (auto& plane : own.lights[0].radiance) show(plane, floats);
    for (auto& plane : own.surface.normal) show(plane, floats);
    for (auto& plane : own.surface.albedo) show(plane, floats);
    for (auto& plane : own.motion) show(plane, floats);
    show(own.surface.depth, floats);
    show(own.previous_depth, floats);
    ids.reserve(1);
    show(own.surface.id, ids);
  }

  Frame own;
  std::vector<ForeignCopy<float>> floats;
  std::vector<ForeignCopy<std::uint32_t>> ids;
};

// A source whose frames are views of other memory.
class ForeignSource final : public FrameSource {
 public:
  explicit ForeignSource(const AnalyticOptions& options) : source_(options) {}

  [[nodiscard]] bool next(Frame& frame) override {
    Frame rendered;
    if (!source_.next(rendered)) return false;
    frames_.push_back(std::make_unique<ForeignFrame>(rendered));
    frame = std::move(frames_.back()->own);
    return true;
  }
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override {
    return source_.resample(extra, frame, means);
  }

 private:
  AnalyticSource source_;
  std::vector<std::unique_ptr<ForeignFrame>> frames_;
};

TEST(ForeignMemory, ViewsGiveTheBitsOfPlanes) {
  const AnalyticOptions options = moving();
  const std::vector<Planes<3>> wanted = run_one_layer(options);
  ForeignSource source(options);
  EigenDenoiser denoiser({options.extent, 3});
  for (const Planes<3>& picture : wanted) {
    const Planes<3>* out = denoiser.step(source);
    ASSERT_NE(out, nullptr);
    EXPECT_TRUE(denoiser.frame().lights[0].radiance[0].is_view());
    ASSERT_TRUE(test::same_bits(*out, picture)) << denoiser.frame().index;
  }
}

}  // namespace
}  // namespace eigenlight
