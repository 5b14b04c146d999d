// Writes the directory of a run as `eigenlight render` does, with made-up light.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "frame/random.h"
#include "sequences/runs/frame_writer.h"
#include "sequences/runs/run_description.h"
#include "sequences/runs/run_log.h"

namespace eigenlight {

struct FakeRun {
  std::string title = "A made-up room";
  Extent extent{96, 54};
  std::vector<int> frames{0};
  std::string layers = {};   ///< empty: all
  bool has_picture = false;  ///< a gray picture in place of the composed color
};

/// A bright disc that moves over a wall, under a sky without surface; the noisy light varies by
/// half.
inline void fill_fake_frame(int number, Frame& frame, Planes<3>& denoised, Plane<float>& age) {
  const Extent extent = frame.extent();
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(extent.width);
      const float v = static_cast<float>(y) / static_cast<float>(extent.height);
      const bool is_sky = v < 0.25f;
      const float disc = std::hypot(u - 0.02f * static_cast<float>(number % 50), v - 0.6f);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto key = hash_key(static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(x),
                                  static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(c));
        const float light = is_sky ? 0.0f : 0.2f + 0.5f * std::exp(-20.0f * disc * disc);
        denoised[c](x, y) = light;
        frame.lights[0].radiance[c](x, y) = light * (0.5f + to_unit(key));
        frame.direct[c](x, y) = is_sky ? 0.0f : 0.3f * u;
        frame.emission[c](x, y) = is_sky ? 0.6f + 0.1f * static_cast<float>(c) : 0.0f;
        frame.surface.albedo[c](x, y) = is_sky ? 0.0f : 0.8f - 0.2f * static_cast<float>(c) * v;
      }
      frame.surface.id(x, y) = is_sky ? 0 : 1;
      frame.surface.depth(x, y) = is_sky ? std::numeric_limits<float>::infinity() : 2.0f + u;
      age(x, y) = is_sky ? 0.0f : x < extent.width / 8 ? 1.0f : 16.0f;
    }
  }
}

inline FrameReport fake_report(int number, const FakeRun& run) {
  FrameReport report;
  report.frame = number;
  report.cut = number == run.frames.front();
  const auto pixels = static_cast<std::int64_t>(run.extent.pixels());
  for (std::size_t s = 0; s < report.time.size(); ++s) {
    const double ms =
        3.0 + static_cast<double>(s) + std::sin(0.3 * number + static_cast<double>(s));
    report.time[s] = {s == 0 ? 10.0 * ms : ms, 1.8 * ms};
  }
  report.rays = 40 * pixels;
  report.surface_pixels = 3 * pixels / 4;
  report.new_pixels = report.cut ? report.surface_pixels : pixels / 30;
  report.mean_rank = 1.0 + 0.5 * std::sin(0.2 * number);
  report.skipped_surface = pixels / 5;
  report.skipped_correction = pixels / 2;
  report.skipped_geometry = pixels / 10;
  return report;
}

inline void write_fake_run(const std::filesystem::path& dir, const FakeRun& run) {
  RunDescription description;
  description.scene = "made-up";
  description.title = run.title;
  description.frames = run.frames;
  description.extent = run.extent;
  description.spp = 3;
  description.method = "running-mean";
  description.perturb = "none";
  std::filesystem::create_directories(dir);
  std::ofstream(dir / "run.json") << to_json_text(description);

  RunLog log(dir, run.frames, 0);
  FrameWriter writer(dir, parse_layers(run.layers), {});
  Frame frame;
  frame.resize(run.extent);
  Planes<3> denoised = make_planes<3>(run.extent);
  Plane<float> age(run.extent);
  Planes<3> picture = make_planes<3>(run.extent);
  for (auto& plane : picture) plane.fill(0.5f);
  for (const int number : run.frames) {
    frame.index = number;
    fill_fake_frame(number, frame, denoised, age);
    writer.write({frame, denoised, age, run.has_picture ? &picture : nullptr});
    log.append(fake_report(number, run), description.spp, {2.0, 2.0});
  }
}

}  // namespace eigenlight
