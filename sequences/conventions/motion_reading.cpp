#include "sequences/conventions/motion_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "frame/check.h"
#include "sequences/conventions/motion_trials.h"

namespace eigenlight {
namespace {

// Pixels on trial, for a pair of frames: the residual of a share of 5 % is then known to 4 % of
// itself.
constexpr int kSampled = 12000;
// For the grid of scales.
constexpr int kSampledForScales = 3000;
// A sign or a unit is told where at least so many pixels, and this share of them, move by it.
constexpr int kFewest = 50;
constexpr double kFewestShare = 0.005;
// A fitted scale is taken if its residual is that much lower than that of a usual unit.
constexpr double kFitGain = 1.15;
// Readings of other channels or frames that differ by less than this share of the motion mean the
// same motion (at a steady pace, backward and forward vectors are alike).
constexpr float kSamePace = 0.25f;
// For fitted scales: one that is a little off is no other meaning.
constexpr float kSamePaceFitted = 0.5f;

struct Rated {
  MotionReading reading;
  double residual = 1.0;
  bool is_fitted = false;  // a scale of its own
};

constexpr std::array<std::array<double, 2>, 4> kSigns{{{1, -1}, {1, 1}, {-1, -1}, {-1, 1}}};

// Every channel pair, direction and sign; units to be filled in.
std::vector<MotionReading> kinds(const MotionTrials& trials) {
  std::vector<MotionReading> kinds;
  for (int pair = 0; pair < 2; ++pair) {
    if (!trials.has_pair(pair)) continue;
    for (const bool backward : {true, false}) {
      for (const auto& sign : kSigns) kinds.push_back({pair, sign[0], sign[1], backward});
    }
  }
  return kinds;
}

MotionReading scaled(MotionReading kind, double x, double y) {
  kind.scale_x *= x;
  kind.scale_y *= y;
  return kind;
}

std::vector<Rated> usual_readings(const MotionTrials& trials, Extent extent) {
  std::vector<Rated> rated;
  const double w = extent.width, h = extent.height;
  for (const MotionReading& kind : kinds(trials)) {
    for (const auto& unit : {std::array{1.0, 1.0}, {w, h}, {w / 2, h / 2}}) {
      const MotionReading reading = scaled(kind, unit[0], unit[1]);
      rated.push_back({reading, trials.residual(reading)});
    }
  }
  return rated;
}

// The best scale near that of `start`: golden section over a factor of 1.4 to both sides.
Rated refine(const MotionTrials& trials, const MotionReading& start) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  const auto rate = [&](double log_scale) {
    const MotionReading reading = scaled(start, std::exp(log_scale), std::exp(log_scale));
    return Rated{reading, trials.residual(reading), true};
  };
  double low = -0.35, high = 0.35;
  double x1 = high - golden * (high - low), x2 = low + golden * (high - low);
  Rated r1 = rate(x1), r2 = rate(x2);
  for (int step = 0; step < 10; ++step) {
    if (r1.residual < r2.residual) {
      high = x2, x2 = x1, r2 = r1;
      x1 = high - golden * (high - low);
      r1 = rate(x1);
    } else {
      low = x1, x1 = x2, r1 = r2;
      x2 = low + golden * (high - low);
      r2 = rate(x2);
    }
  }
  return r1.residual < r2.residual ? r1 : r2;
}

// For every kind the best of a grid of scales: pixels per unit, and pictures per unit. Half of the
// pixels then move by between a quarter of a pixel and a tenth of the picture.
std::vector<Rated> scaled_readings(const MotionTrials& few, Extent extent) {
  std::vector<Rated> rated;
  const double longest = 0.1 * std::max(extent.width, extent.height);
  const double aspect = static_cast<double>(extent.height) / extent.width;
  for (const MotionReading& kind : kinds(few)) {
    const double raw = few.raw_length(kind.pair, kind.backward);
    if (!(raw > 0.0)) continue;
    for (const double y : {1.0, aspect}) {
      Rated best;
      for (double length = 0.25; length < longest; length *= 1.25) {
        const MotionReading reading = scaled(kind, length / raw, y * length / raw);
        const double residual = few.residual(reading);
        if (residual < best.residual) best = {reading, residual, true};
      }
      if (best.residual < 1.0) rated.push_back(best);
      if (extent.width == extent.height) break;
    }
  }
  return rated;
}

// Where a file holds both (Cycles), or all moves at a steady pace, other readings are about as good
// as backward vectors in the first pair: they have to be better by that.
constexpr double kForward = 1.1, kSecond = 1.05;

double rank(const Rated& rated) {
  return rated.residual * (rated.reading.backward ? 1.0 : kForward) *
         (rated.reading.pair == 0 ? 1.0 : kSecond);
}

bool is_better(const Rated& a, const Rated& b) { return rank(a) < rank(b); }

bool is_same_kind(const MotionReading& a, const MotionReading& b) {
  return a.pair == b.pair && a.backward == b.backward;
}

bool near_scale(const MotionReading& a, const MotionReading& b) {
  const double x = a.scale_x / b.scale_x, y = a.scale_y / b.scale_y;
  return a.pair == b.pair && x > 0.5 && x < 2.0 && y > 0.5 && y < 2.0;
}

// A scale of its own in place of the best usual unit, where it is clearly better.
Rated choose(const MotionTrials& trials, const Rated& usual, const std::vector<Rated>& fitted) {
  Rated best = usual;
  double limit = rank(usual) / kFitGain;
  for (const Rated& entry : fitted) {
    const Rated fine = refine(trials, entry.reading);
    if (rank(fine) >= limit) continue;
    best = fine;
    limit = rank(fine);
  }
  return best;
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

constexpr const char* kAdvice =
    "; say --motion, for example --motion cycles or --motion x,-y,pixels,backward";

// Whether enough pixels move differently.
bool is_told(const MotionContest& contest) {
  return contest.pixels >= kFewest && contest.share >= kFewestShare;
}

double ratio_of(const MotionContest& contest) {
  return contest.other / std::max(contest.best, 1e-6);
}

// Whether `other` is another meaning, not the same one a little off.
bool is_rival(const MotionTrials& trials, const MotionReading& best, const Rated& other) {
  if (other.reading == best || near_scale(other.reading, best)) return false;
  return is_same_kind(other.reading, best) ||
         !trials.same_pace(best, other.reading, other.is_fitted ? kSamePaceFitted : kSamePace);
}

std::string words_of(const MotionFit& fit, Extent extent, const std::string& untold, double ratio) {
  const std::string name = format_motion(fit.best, extent);
  if (!untold.empty()) {
    return fmt::format("motion: the frames do not tell {} from {}{}", name, untold, kAdvice);
  }
  const std::string figures = fmt::format(
      "{} of what its vectors lead to does not match, with the next best ({}) {}",
      percent(fit.residual), format_motion(fit.next, extent), percent(fit.next_residual));
  return ratio < kClearRatio
             ? fmt::format("motion: no reading is clearly best: {}, {}{}", name, figures, kAdvice)
             : fmt::format("motion is {}: {}", name, figures);
}

// Looks for the rival that comes closest to the best, and for what the frames do not tell.
void judge(const MotionTrials& trials, const std::vector<Rated>& all, Extent extent,
           MotionFit& fit) {
  const MotionContest still = trials.contest(fit.best, nullptr);
  fit.residual = still.best;
  fit.next_residual = fit.still_residual = still.other;
  if (!is_told(still)) {
    fit.words = fmt::format("motion: nothing moves by more than half a pixel{}", kAdvice);
    return;
  }
  double least = std::numeric_limits<double>::infinity();
  std::string untold;
  for (const Rated& other : all) {
    if (!is_rival(trials, fit.best, other)) continue;
    const MotionContest contest = trials.contest(fit.best, &other.reading);
    if (!is_told(contest)) {
      if (untold.empty() && is_same_kind(other.reading, fit.best)) {
        untold = format_motion(other.reading, extent);
      }
    } else if (ratio_of(contest) < least) {
      least = ratio_of(contest);
      fit.next = other.reading;
      fit.residual = contest.best;
      fit.next_residual = contest.other;
    }
  }
  least = std::min(least, ratio_of(still));
  fit.is_clear = untold.empty() && least >= kClearRatio;
  fit.words = words_of(fit, extent, untold, least);
}

}  // namespace

MotionFit find_motion(std::span<const RawGuides> frames) {
  MotionFit fit;
  EL_CHECK(frames.size() >= 2, "motion: {} frames, expected at least two", frames.size());
  const Extent extent = frames[0].extent();
  for (const RawGuides& frame : frames) {
    EL_CHECK(frame.extent() == extent, "motion: frame {} is {}x{}, frame {} {}x{}", frame.frame,
             frame.extent().width, frame.extent().height, frames[0].frame, extent.width,
             extent.height);
  }
  const MotionTrials trials(frames, kSampled);
  const MotionTrials few(frames, kSampledForScales);
  if (!trials.has_pair(0)) {
    fit.words = "motion: the files hold none";
    return fit;
  }
  std::vector<Rated> usual = usual_readings(trials, extent);
  const std::vector<Rated> fitted = scaled_readings(few, extent);
  const Rated first = *std::min_element(usual.begin(), usual.end(), is_better);
  const auto by_rank = [&] {
    std::vector<Rated> sorted = fitted;
    std::sort(sorted.begin(), sorted.end(), is_better);
    sorted.resize(std::min<std::size_t>(sorted.size(), 4));
    return sorted;
  }();
  const Rated best = choose(trials, first, by_rank);
  fit.best = fit.next = best.reading;
  usual.insert(usual.end(), fitted.begin(), fitted.end());
  judge(trials, usual, extent, fit);
  return fit;
}

}  // namespace eigenlight
