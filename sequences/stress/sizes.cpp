// Images of unusual sizes.
#include <fmt/format.h>

#include <array>

#include "sequences/stress/measures.h"
#include "sequences/stress/memory.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

// Error / error of the input, both summed over the frames; the camera slides.
StressFinding check_odd(StressLog& log) {
  constexpr std::array<Extent, 9> kExtents{
      {{1, 1}, {2, 1}, {3, 5}, {7, 13}, {1, 4096}, {4096, 1}, {31, 33}, {127, 61}, {193, 97}}};
  for (const Extent extent : kExtents) {
    AnalyticOptions options{.extent = extent, .frames = 8};
    options.slide = {0.5f, 0.25f};
    StressRun noisy(log, options, "noisy"), run(log, options);
    double error = 0.0, input = 0.0;
    while (noisy.step() && run.step()) {
      error += relative_error(run);
      input += relative_error(noisy);
    }
    log.note(error / input, fmt::format("{}x{}", extent.width, extent.height));
  }
  return worst_of(log, 1.0);
}

// Bytes per pixel of an 8K frame: with three bases the planes of Frame (92), history (136) and
// scratch (138) take 366; the bound leaves 4 % for the rest.
StressFinding check_8k(StressLog& log) {
  constexpr Extent kExtent{7680, 4320};
  const double before = resident_bytes();
  AnalyticOptions options{.extent = kExtent, .frames = 2};
  options.slide = {0.5f, 0.25f};
  StressRun run(log, options);
  while (run.step()) {
  }
  const double pixels = static_cast<double>(kExtent.pixels());
  log.note((resident_bytes() - before) / pixels);
  StressFinding finding = worst_of(log, 380.0);
  finding.note = fmt::format("peak memory {:.2f} GB, relative error {:.4f}", peak_bytes() * 1e-9,
                             relative_error(run));
  return finding;
}

}  // namespace

std::vector<StressCase> size_cases() {
  return {{"sizes.odd", "1x1 to 4096x1 and primes: error / error of the input", false, check_odd},
          {"sizes.8k", "7680x4320, two frames: bytes of memory per pixel", true, check_8k}};
}

}  // namespace eigenlight
