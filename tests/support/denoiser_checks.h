// Checks that every method with a history must pass, on analytic sources.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string_view>

#include "frame/tiles.h"
#include "temporal/methods.h"
#include "tests/support/analytic_source.h"

namespace eigenlight {

/// mean((x - truth)^2 / truth^2) over the pixels with a surface.
inline double relative_error(const Planes<3>& x, const AnalyticSource& source, const Frame& frame) {
  double sum = 0.0, count = 0.0;
  for (int j = 0; j < frame.extent().height; ++j) {
    for (int i = 0; i < frame.extent().width; ++i) {
      if (frame.surface.id(i, j) == 0) continue;
      for (int c = 0; c < 3; ++c) {
        const double truth = static_cast<double>(source.truth({i, j}, c, frame.index));
        const double value = static_cast<double>(x[static_cast<std::size_t>(c)](i, j));
        sum += (value / truth - 1.0) * (value / truth - 1.0);
        count += 1.0;
      }
    }
  }
  return sum / count;
}

/// Mean of x / truth - 1 of the green channel over the pixels with a surface.
inline double relative_bias(const Planes<3>& x, const AnalyticSource& source, const Frame& frame) {
  double sum = 0.0, count = 0.0;
  for (int j = 0; j < frame.extent().height; ++j) {
    for (int i = 0; i < frame.extent().width; ++i) {
      if (frame.surface.id(i, j) == 0) continue;
      sum += static_cast<double>(x[1](i, j) / source.truth({i, j}, 1, frame.index)) - 1.0;
      count += 1.0;
    }
  }
  return sum / count;
}

/// Whether all pixels have the same bits; padding is ignored.
inline bool same_bits(const Planes<3>& a, const Planes<3>& b) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      const auto bytes = static_cast<std::size_t>(a[c].width()) * sizeof(float);
      if (std::memcmp(a[c].row(y), b[c].row(y), bytes) != 0) return false;
    }
  }
  return true;
}

inline bool all_finite(const Planes<3>& planes) {
  for (const auto& plane : planes) {
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) {
        if (!std::isfinite(plane(x, y))) return false;
      }
    }
  }
  return true;
}

/// The last of options.frames pictures of a new denoiser.
inline Planes<3> last_picture(std::string_view method, const AnalyticOptions& options) {
  const auto denoiser = make_denoiser(method, {options.extent, 3});
  AnalyticSource source(options);
  Planes<3> last = make_planes<3>(options.extent);
  while (const Planes<3>* out = denoiser->step(source)) copy_planes(*out, last);
  return last;
}

/// A method that is saved between two frames and loaded into another denoiser goes on with the same
/// bits.
inline void expect_resumes(std::string_view method) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 9};
  options.slide = {1.3f, -0.4f};
  const Planes<3> straight = last_picture(method, options);

  const auto first = make_denoiser(method, {options.extent, 3});
  AnalyticSource source(options);
  for (int i = 0; i < 5; ++i) ASSERT_NE(first->step(source), nullptr);
  StateWriter state;
  first->save(state);
  const auto second = make_denoiser(method, {options.extent, 3});
  StateReader reader({state.bytes().data(), state.bytes().size()});
  second->load(reader);
  reader.finish();
  const Planes<3>* out = nullptr;
  for (int i = 5; i < 9; ++i) out = second->step(source);
  ASSERT_NE(out, nullptr);
  EXPECT_FALSE(second->report().cut);
  EXPECT_TRUE(same_bits(*out, straight));

  StateReader wrong({state.bytes().data(), state.bytes().size()});
  EXPECT_THROW(make_denoiser("noisy", {options.extent, 3})->load(wrong), std::runtime_error);
  StateReader narrow({state.bytes().data(), state.bytes().size()});
  EXPECT_THROW(make_denoiser(method, {{64, 17}, 3})->load(narrow), std::runtime_error);
}

/// A reset, or a frame that does not follow the previous one, drops all history.
inline void expect_forgets_at_cuts(std::string_view method) {
  AnalyticOptions fresh{.frames = 1};
  fresh.first_frame = 6;
  const Planes<3> alone = last_picture(method, fresh);
  AnalyticOptions cut{.frames = 7};
  cut.edit = [](Frame& frame) { frame.previous_index -= frame.index == 6 ? 1 : 0; };
  EXPECT_TRUE(same_bits(last_picture(method, cut), alone));

  const auto denoiser = make_denoiser(method, {cut.extent, 3});
  AnalyticSource source({.frames = 7});
  const Planes<3>* out = nullptr;
  for (int i = 0; i < 7; ++i) {
    if (i == 6) denoiser->reset();
    out = denoiser->step(source);
    EXPECT_EQ(denoiser->report().cut, i == 0 || i == 6);
  }
  EXPECT_TRUE(same_bits(*out, alone));
}

/// FrameInput::is_static lets a method skip work but changes no bit of the result.
inline void expect_still_frames_change_nothing(std::string_view method) {
  AnalyticOptions still{.extent = {65, 17}, .frames = 6};
  AnalyticOptions unknown = still;
  unknown.edit = [](Frame& frame) { frame.is_static = false; };
  EXPECT_TRUE(same_bits(last_picture(method, still), last_picture(method, unknown)));
}

inline void expect_same_bits_on_any_number_of_threads(std::string_view method) {
  AnalyticOptions options{.extent = {191, 107}, .frames = 4};
  options.slide = {0.7f, 0.3f};
  set_thread_count(1);
  const Planes<3> one = last_picture(method, options);
  set_thread_count(2);
  EXPECT_TRUE(same_bits(one, last_picture(method, options)));
  set_thread_count(0);
}

/// Noisy light in images of one pixel and of odd sizes, under a moving camera: the mean over a
/// picture is right up to its noise. A frame of another size is rejected.
inline void expect_runs_at_any_size(std::string_view method) {
  for (const Extent extent : {Extent{1, 1}, Extent{5, 3}, Extent{65, 17}}) {
    AnalyticOptions options{.extent = extent, .frames = 5, .pattern = 0.0f};
    options.slide = {0.6f, 0.2f};
    AnalyticSource source(options);
    const auto denoiser = make_denoiser(method, {extent, 3});
    // Four standard deviations of the mean over one frame, and what methods lose by bounding light.
    const double noise =
        options.noise / std::sqrt(options.spp * static_cast<double>(extent.pixels()));
    while (const Planes<3>* out = denoiser->step(source)) {
      EXPECT_TRUE(all_finite(*out));
      EXPECT_NEAR(relative_bias(*out, source, denoiser->frame()), 0.0, 4.0 * noise + 0.02)
          << extent.width << "x" << extent.height << ", frame " << denoiser->report().frame;
    }
  }
  AnalyticSource source({});
  EXPECT_THROW((void)make_denoiser(method, {{63, 36}, 3})->step(source), std::invalid_argument);
}

/// Constant light without noise keeps its value at every pixel of images of any size.
inline void expect_keeps_constant_light(std::string_view method, float tolerance) {
  for (const Extent extent : {Extent{1, 1}, Extent{5, 3}, Extent{64, 36}}) {
    AnalyticOptions options{.extent = extent, .frames = 10, .noise = 0.0f, .pattern = 0.0f};
    options.gain = [](int) { return 0.75f; };
    // Points of small images must stay visible for some frames.
    options.slide = glm::vec2(0.5f, 0.25f) * (extent.width < 64 ? 0.1f : 1.0f);
    const Planes<3> out = last_picture(method, options);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        for (const auto& plane : out) ASSERT_NEAR(plane(x, y), 0.75f, tolerance) << x << ", " << y;
      }
    }
  }
}

/// What a method makes of two non-finite values in light without noise.
struct NonFiniteLight {
  bool fills = true;  ///< a new pixel gets light from its surroundings; else it stays 0
  double relative = 0.0, absolute = 1e-5;  ///< bounds on what the values add to the error
};

/// Light that is not finite is counted and left out: it does not spread, and the picture is as good
/// as without. `make(extent)` makes the denoiser.
template <typename Make>
void expect_leaves_out_non_finite_light(const Make& make, const NonFiniteLight& expected) {
  AnalyticOptions clean{.frames = 6, .noise = 0.0f};
  clean.slide = {0.5f, 0.5f};
  AnalyticOptions broken = clean;
  broken.edit = [](Frame& frame) {
    auto& light = frame.lights[0].radiance;
    if (frame.index == 0) light[1](30, 20) = std::numeric_limits<float>::quiet_NaN();
    if (frame.index == 3) light[2](40, 10) = -std::numeric_limits<float>::infinity();
  };
  AnalyticSource source(broken), untouched(clean);
  const std::unique_ptr<Denoiser> denoiser = make(broken.extent), other = make(clean.extent);
  for (int frame = 0; frame < 6; ++frame) {
    const Planes<3>* out = denoiser->step(source);
    const Planes<3>* wanted = other->step(untouched);
    EXPECT_EQ(denoiser->report().non_finite_pixels, frame == 0 || frame == 3 ? 1 : 0);
    EXPECT_TRUE(all_finite(*out));
    if (frame == 0) {
      EXPECT_EQ(denoiser->age()(30, 20), 0.0f);
      const float light = expected.fills ? source.truth({30, 20}, 1, 0) : 0.0f;
      EXPECT_NEAR((*out)[1](30, 20), light, expected.fills ? 0.15f : 0.0f);
      if (!expected.fills) continue;
    }
    const double usual = relative_error(*wanted, untouched, other->frame());
    EXPECT_LT(relative_error(*out, source, denoiser->frame()),
              usual * (1.0 + expected.relative) + expected.absolute)
        << frame;
  }
}

/// Noisy light of 1 under a sliding camera, with a sky of 6 columns.
struct SmoothingBounds {
  glm::vec2 slide;
  double first, last;       ///< error of the first and of the twelfth picture, over that of a frame
  std::int64_t new_pixels;  ///< that the slide uncovers
};

inline void expect_smooths_noise(std::string_view method, const SmoothingBounds& bounds) {
  AnalyticOptions options{.extent = {96, 54}, .frames = 12, .pattern = 0.0f};
  options.slide = bounds.slide;
  options.sky_columns = 6;
  AnalyticSource source(options);
  const auto denoiser = make_denoiser(method, {options.extent, 1});
  for (int frame = 0; frame < 12; ++frame) {
    const Planes<3>* out = denoiser->step(source);
    const double error = relative_error(*out, source, denoiser->frame()) / (0.25 / 3.0);
    if (frame == 0) {
      EXPECT_LT(error, bounds.first);
    }
    if (frame == 11) {
      EXPECT_LT(error, bounds.last);
    }
    EXPECT_EQ((*out)[0](2, 30), 0.0f);
  }
  EXPECT_EQ(denoiser->age()(2, 30), 0.0f);
  EXPECT_NEAR(denoiser->age()(50, 50), 12.0f, 0.01f);
  EXPECT_EQ(denoiser->report().surface_pixels, 90 * 54);
  EXPECT_EQ(denoiser->report().new_pixels, bounds.new_pixels);
}

}  // namespace eigenlight
