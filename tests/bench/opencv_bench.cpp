// The guided filter with one guide beside cv::ximgproc::guidedFilter on the same guide, light and
// window, one thread each. It refuses to time results that differ by more than 1e-3 anywhere inside
// of the image: within 2 radius of its sides windows reach beyond it, which OpenCV fills by
// reflection and we leave empty. Counters as in floors.h, opencv_ms of CPU time, and opencv_ratio =
// opencv_ms / cpu_ms, measured by turns.
#include <benchmark/benchmark.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/ximgproc/edge_filter.hpp>
#include <string>
#include <vector>

#include "frame/luminance.h"
#include "spatial/rivals/guided_spatial.h"
#include "tests/bench/floors.h"
#include "tests/bench/register.h"
#include "tests/bench/room.h"

namespace eigenlight {
namespace {

constexpr double kAllowed = 1e-3;

/// A frame of the room without sky, which OpenCV could not leave out.
Frame closed_room(Extent extent) {
  const RoomLap lap(extent);
  Frame frame;
  frame.resize(extent);
  const Frame& from = lap.frames[0];
  copy_planes(from.lights[0].radiance, frame.lights[0].radiance);
  copy_planes(from.surface.normal, frame.surface.normal);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const float depth = from.surface.depth(x, y);
      frame.surface.depth(x, y) = std::isfinite(depth) ? depth : 1.0f;
      frame.surface.id(x, y) = 1;
    }
  }
  return frame;
}

cv::Mat gray_normals(const Frame& frame) {
  cv::Mat gray(frame.extent().height, frame.extent().width, CV_32FC1);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      gray.at<float>(y, x) = luminance(frame.surface.normal, x, y);
    }
  }
  return gray;
}

cv::Mat light(const Frame& frame) {
  cv::Mat image(frame.extent().height, frame.extent().width, CV_32FC3);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        image.at<cv::Vec3f>(y, x)[c] = frame.lights[0].radiance[static_cast<std::size_t>(c)](x, y);
      }
    }
  }
  return image;
}

double largest_difference(const Planes<3>& ours, const cv::Mat& theirs, int border) {
  double most = 0.0;
  for (int y = border; y < theirs.rows - border; ++y) {
    for (int x = border; x < theirs.cols - border; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double difference =
            std::abs(static_cast<double>(ours[static_cast<std::size_t>(c)](x, y)) -
                     static_cast<double>(theirs.at<cv::Vec3f>(y, x)[c]));
        if (!(difference <= most)) most = difference;
      }
    }
  }
  return most;
}

void guided_and_opencv(benchmark::State& state) {
  set_thread_count(1);
  cv::setNumThreads(1);
  const int height = static_cast<int>(state.range(0)), radius = static_cast<int>(state.range(1));
  const Extent extent{height * 16 / 9, height};
  const Frame frame = closed_room(extent);
  const cv::Mat guide = gray_normals(frame), source = light(frame);
  const GuidedOptions options{.radius = radius, .guides = Guides::kGrayNormal};
  Plane<float> weight(extent);
  weight.fill(1.0f);
  Planes<3> ours = make_planes<3>(extent);
  cv::Mat theirs;
  GuidedSpatial filter(extent, options);
  const auto run = timed([&] { filter.process({frame, frame.lights[0].radiance, weight}, ours); });
  const auto run_opencv = timed([&] {
    cv::ximgproc::guidedFilter(guide, source, theirs, radius,
                               static_cast<double>(options.epsilon_normal));
  });
  benchmark::DoNotOptimize(run() + run_opencv());
  const double difference = largest_difference(ours, theirs, std::min(2 * radius, height / 3));
  if (!(difference <= kAllowed)) {
    return state.SkipWithError(("differs from OpenCV by " + std::to_string(difference)).c_str());
  }
  std::vector<double> opencv;
  measure(state, extent, {9 * kFloat, 3 * kFloat}, [&] {
    opencv.push_back(run_opencv());
    return run();
  });
  state.counters["difference"] = difference;
  state.counters["opencv_ms"] = median(std::move(opencv));
  state.counters["opencv_ratio"] = state.counters["opencv_ms"] / state.counters["cpu_ms"];
}

BENCHMARK(guided_and_opencv)->Apply([](auto* bench) {
  bench->ArgNames({"height", "radius"})
      ->ArgsProduct({bench_heights({360, 720}), {8, 16, 32}})
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
});

}  // namespace
}  // namespace eigenlight
