// What every method with a history has to do, for tests on analytic sources.
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

/// Bit for bit, but for padding.
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

/// The last of options.frames pictures of a fresh denoiser.
inline Planes<3> last_picture(std::string_view method, const AnalyticOptions& options) {
  const auto denoiser = make_denoiser(method, {options.extent, 3});
  AnalyticSource source(options);
  Planes<3> last = make_planes<3>(options.extent);
  while (const Planes<3>* out = denoiser->step(source)) copy_planes(*out, last);
  return last;
}

/// A method that is saved between two frames and loaded elsewhere goes on with the same bits.
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

/// A frame that follows another than the one before, or a reset, drops all history.
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

/// That nothing moved is a reason to skip work, and no reason for another result.
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

/// Images of one pixel and of odd sizes, under a moving camera.
inline void expect_runs_at_any_size(std::string_view method) {
  for (const Extent extent : {Extent{1, 1}, Extent{5, 3}, Extent{65, 17}}) {
    AnalyticOptions options{.extent = extent, .frames = 5};
    options.slide = {0.6f, 0.2f};
    EXPECT_TRUE(all_finite(last_picture(method, options)));
  }
  AnalyticSource source({});
  EXPECT_THROW((void)make_denoiser(method, {{63, 36}, 3})->step(source), std::invalid_argument);
}

}  // namespace eigenlight
