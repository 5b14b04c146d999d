// Runs that do not end: no drift, no growth, no loss of what the algebra needs.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "sequences/stress/measures.h"
#include "sequences/stress/memory.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{32, 32};
constexpr int kMemory = 64;  // frames: the age limit

// Mean error of the frames [first, last), of one run or several.
class Window {
 public:
  Window(int first, int last) : first_(first), last_(last) {}
  void take(int frame, double error) {
    if (frame < first_ || frame >= last_) return;
    sum_ += error;
    ++taken_;
  }
  [[nodiscard]] double mean() const { return sum_ / taken_; }

 private:
  int first_, last_, taken_ = 0;
  double sum_ = 0.0;
};

// Over 40 starts: error at each frame n from 8 on, over that of the mean of all samples so far,
// noise^2 / (3 n). Not 1 / n of the error at frame 8, because the spatial filter takes off most at
// the beginning.
StressFinding check_falls(Lab& lab) {
  constexpr int kStarts = 40;
  std::vector<double> error(kMemory);
  for (std::uint32_t start = 0; start < kStarts; ++start) {
    AnalyticOptions options{.extent = kExtent, .frames = kMemory};
    options.seed = start;
    options.is_gray = true;
    StressRun run(lab, options);
    while (run.step()) {
      error[static_cast<std::size_t>(run.frame().index)] += relative_error(run) / kStarts;
    }
  }
  for (int n = 8; n <= kMemory; ++n) {
    lab.note(error[static_cast<std::size_t>(n - 1)] * 3.0 * n / 0.25, fmt::format("frame {}", n));
  }
  return worst_of(lab, 1.0);
}

// Mean error over `window` frames at the end, over that from frame `from` on, each the mean of
// `starts` runs.
StressFinding stays(Lab& lab, AnalyticOptions options, int from, int window, std::uint32_t starts) {
  Window early(from, from + window), late(options.frames - window, options.frames);
  for (std::uint32_t start = 0; start < starts; ++start) {
    options.seed = start;
    StressRun run(lab, options);
    while (run.step()) {
      const double error = relative_error(run);
      early.take(run.frame().index, error);
      late.take(run.frame().index, error);
      if (std::isnan(error)) lab.note(error);
    }
  }
  lab.note(late.mean() / early.mean());
  return worst_of(lab, 1.05);
}

// 2000 frames of 64 frames of memory are 31 independent pictures of some 30 independent pixels
// each: chance 3 %.
StressFinding check_still(Lab& lab) {
  return stays(lab, {.extent = kExtent, .frames = 100'000}, 2 * kMemory, 2000, 1);
}

constexpr int kPeriod = 980;  // frames; 200 and 10,000 are the same moment of it
// A period is 15 independent pictures of some 30 independent pixels: chance 9 % of the ratio of two
// (0.86 to 1.14 in fourteen runs), 3 % with so many starts.
constexpr std::uint32_t kPeriodStarts = 8;

float turn(int frame) {
  return 2.0f * std::numbers::pi_v<float> * static_cast<float>(frame % kPeriod) / kPeriod;
}

StressFinding check_drift(Lab& lab) {
  AnalyticOptions options{.extent = kExtent, .frames = 200 + 10 * kPeriod};
  options.gain = [](int f) { return 1.0f + 0.5f * std::sin(turn(f)); };
  options.light = [](glm::vec2 at, int f) { return 1.0f + 0.3f * std::sin(0.1f * at.x + turn(f)); };
  return stays(lab, options, 200, kPeriod, kPeriodStarts);
}

StressFinding check_circle(Lab& lab) {
  AnalyticOptions options{.extent = kExtent, .frames = 200 + 10 * kPeriod};
  options.path = [](int f) {
    return 60.0f * glm::vec2(std::cos(turn(f + kPeriod)), std::sin(turn(f + kPeriod)));
  };
  return stays(lab, options, 200, kPeriod, kPeriodStarts);
}

// Between frame 1000, when all is allocated, and the end.
StressFinding check_memory(Lab& lab) {
  StressRun run(lab, {.extent = kExtent, .frames = 50'000});
  double start = 0.0;
  while (run.step()) {
    if (run.frame().index == 1000) start = resident_bytes();
  }
  lab.note((resident_bytes() - start) / 1024.0);
  return worst_of(lab, 256.0);
}

}  // namespace

std::vector<StressCase> long_cases() {
  return {
      {"long.falls", "frames 8 to 64: error over that of the mean of all samples so far", false,
       check_falls},
      {"long.still", "100,000 still frames: error at the end over that of the first 2000", true,
       check_still},
      {"long.drift",
       "light that drifts for 10,000 frames: error at the end over that at 200; mean of 8 starts",
       true, check_drift},
      {"long.circle",
       "camera that circles for 10,000 frames: error at the end over that at 200; mean of 8 starts",
       true, check_circle},
      {"long.memory", "50,000 frames: growth of memory in kB", true, check_memory}};
}

}  // namespace eigenlight
