// The smallest use of the library: noisy frames in, a steady picture out. Exits with 1 if the
// picture is as noisy as the frames.
#include <cmath>
#include <cstdio>
#include <vector>

#include "frame/memory_source.h"
#include "frame/random.h"
#include "temporal/eigen/eigen_denoiser.h"

namespace {

constexpr eigenlight::Extent kExtent{96, 54};
constexpr int kFrames = 8;

// A wall of light 1, seen by a camera that stands still, with noise of 0.5.
eigenlight::Frame noisy_wall(int index) {
  eigenlight::Frame frame;
  frame.resize_input(kExtent);
  frame.index = index;
  frame.previous_index = index - 1;
  frame.is_static = index > 0;
  frame.spp = 1;
  frame.camera.focal = 100.0f;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      frame.surface.id(x, y) = 1;
      frame.surface.depth(x, y) = frame.previous_depth(x, y) = 4.0f;
      frame.surface.normal[2](x, y) = -1.0f;
      for (int c = 0; c < 3; ++c) {
        const auto bits =
            eigenlight::hash_key(static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(x),
                                 static_cast<std::uint32_t>(y));
        frame.surface.albedo[c](x, y) = 0.5f;
        frame.lights[0].radiance[c](x, y) = 0.5f + eigenlight::to_unit(bits);
      }
    }
  }
  return frame;
}

double deviation(const eigenlight::Plane<float>& plane) {
  double sum = 0.0;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) sum += std::pow(plane(x, y) - 1.0, 2.0);
  }
  return std::sqrt(sum / static_cast<double>(kExtent.pixels()));
}

}  // namespace

int main() {
  std::vector<eigenlight::Frame> frames;
  for (int i = 0; i < kFrames; ++i) frames.push_back(noisy_wall(i));
  eigenlight::MemorySource source(frames);
  eigenlight::EigenDenoiser denoiser({.extent = kExtent});
  double last = 1.0;
  while (const auto* picture = denoiser.step(source)) last = deviation((*picture)[0]);
  const double noisy = deviation(frames.back().lights[0].radiance[0]);
  std::printf("deviation %.3f, of the noisy frame %.3f\n", last, noisy);
  return last < 0.25 * noisy ? 0 : 1;
}
