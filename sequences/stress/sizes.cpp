// Images of every size that is allowed.
#include <fmt/format.h>

#include <array>

#include "sequences/stress/measures.h"
#include "sequences/stress/memory.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

// Error over that of the input, both summed over the frames, under a camera that slides.
StressFinding check_odd(Lab& lab) {
  constexpr std::array<Extent, 9> kExtents{
      {{1, 1}, {2, 1}, {3, 5}, {7, 13}, {1, 4096}, {4096, 1}, {31, 33}, {127, 61}, {193, 97}}};
  for (const Extent extent : kExtents) {
    AnalyticOptions options{.extent = extent, .frames = 8};
    options.slide = {0.5f, 0.25f};
    StressRun noisy(lab, options, "noisy"), run(lab, options);
    double error = 0.0, input = 0.0;
    while (noisy.step() && run.step()) {
      error += relative_error(run);
      input += relative_error(noisy);
    }
    lab.note(error / input, fmt::format("{}x{}", extent.width, extent.height));
  }
  return worst_of(lab, 1.0);
}

// Bytes of history, scratch and frame for each pixel of an 8K frame: with three bases the planes of
// Frame (92), history (136) and scratch (138) come to 366; 4 % for all else.
StressFinding check_8k(Lab& lab) {
  constexpr Extent kExtent{7680, 4320};
  const double before = resident_bytes();
  AnalyticOptions options{.extent = kExtent, .frames = 2};
  options.slide = {0.5f, 0.25f};
  StressRun run(lab, options);
  while (run.step()) {
  }
  const double pixels = static_cast<double>(kExtent.pixels());
  lab.note((resident_bytes() - before) / pixels);
  StressFinding finding = worst_of(lab, 380.0);
  finding.note = fmt::format("peak memory {:.2f} GB, relative error {:.4f}", peak_bytes() * 1e-9,
                             relative_error(run));
  return finding;
}

}  // namespace

std::vector<StressCase> size_cases() {
  return {{"sizes.odd", "1x1 to 4096x1 and primes: error over that of the input", false, check_odd},
          {"sizes.8k", "7680x4320, two frames: bytes of memory for each pixel", true, check_8k}};
}

}  // namespace eigenlight
