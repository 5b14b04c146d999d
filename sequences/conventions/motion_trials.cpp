#include "sequences/conventions/motion_trials.h"

#include <algorithm>
#include <cmath>

#include "sequences/conventions/background.h"
#include "sequences/conventions/sampling.h"

namespace eigenlight {
namespace {

// Vectors beyond it lead out of every picture, and squares of them stay finite.
constexpr float kLongest = 1e6f;

glm::vec2 apply(const MotionReading& reading, const RawVector& vector) {
  const glm::vec2 scaled =
      glm::vec2(static_cast<float>(reading.scale_x), static_cast<float>(reading.scale_y)) *
      vector.pair[reading.pair];
  return glm::clamp(scaled, -kLongest, kLongest);
}

// The length that a tenth of the vectors exceed.
float fast(const std::vector<RawVector>& vectors, int pair) {
  std::vector<float> lengths;
  for (const RawVector& vector : vectors) lengths.push_back(glm::length(vector.pair[pair]));
  return quantile(std::move(lengths), 0.9);
}

bool read_vector(const RawGuides& frame, int pairs, int x, int y, RawVector& vector) {
  vector.x = x;
  vector.y = y;
  for (int pair = 0; pair < pairs; ++pair) {
    for (int axis = 0; axis < 2; ++axis) {
      const float value = frame.motion[static_cast<std::size_t>(2 * pair + axis)](x, y);
      if (!std::isfinite(value)) return false;
      vector.pair[pair][axis] = std::clamp(value, -kLongest, kLongest);
    }
  }
  return true;
}

}  // namespace

MotionTrial::MotionTrial(const RawGuides& before, const RawGuides& now, int count)
    : before_(before),
      now_(now),
      pairs_(static_cast<int>(std::min(before.motion.size(), now.motion.size()) / 2)) {
  pairs_ = std::min(pairs_, 2);
  sample(now, count, now_vectors_);
  sample(before, count, before_vectors_);
}

void MotionTrial::sample(const RawGuides& frame, int count, std::vector<RawVector>& vectors) const {
  const Extent extent = frame.extent();
  const int step = grid_step(extent, count);
  for (int y = step / 2; y < extent.height; y += step) {
    for (int x = step / 2; x < extent.width; x += step) {
      if (!frame.depth.empty() && is_background(frame.depth(x, y))) continue;
      RawVector vector;
      if (read_vector(frame, pairs_, x, y, vector)) vectors.push_back(vector);
    }
  }
  const float least[2] = {0.1f * fast(vectors, 0), 0.1f * fast(vectors, 1)};
  std::erase_if(vectors, [&](const RawVector& vector) {
    for (int pair = 0; pair < pairs_; ++pair) {
      if (least[pair] > 0.0f && glm::length(vector.pair[pair]) > least[pair]) return false;
    }
    return true;
  });
}

Mismatch MotionTrial::compare(const MotionReading& reading, std::span<const int> where, bool all,
                              bool is_still) const {
  const std::vector<RawVector>& from = reading.backward ? now_vectors_ : before_vectors_;
  std::vector<PixelVector> vectors;
  vectors.reserve(from.size());
  const float sign = reading.backward ? 1.0f : -1.0f;
  const auto add = [&](const RawVector& vector) {
    const glm::vec2 to = is_still ? glm::vec2(0.0f) : sign * apply(reading, vector);
    vectors.push_back({vector.x, vector.y, to});
  };
  if (all) {
    for (const RawVector& vector : from) add(vector);
  } else {
    for (const int index : where) add(from[static_cast<std::size_t>(index)]);
  }
  return reading.backward ? compare_along(now_, before_, vectors)
                          : compare_along(before_, now_, vectors);
}

Mismatch MotionTrial::mismatch(const MotionReading& reading) const {
  return compare(reading, {}, true, false);
}

Mismatch MotionTrial::mismatch(const MotionReading& reading, std::span<const int> where) const {
  return compare(reading, where, false, false);
}

Mismatch MotionTrial::still(const MotionReading& best, std::span<const int> where) const {
  return compare(best, where, false, true);
}

std::vector<int> MotionTrial::differing(const MotionReading& best,
                                        const MotionReading* other) const {
  const std::vector<RawVector>& vectors = best.backward ? now_vectors_ : before_vectors_;
  std::vector<int> where;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const glm::vec2 here = apply(best, vectors[i]);
    const glm::vec2 there = other != nullptr ? apply(*other, vectors[i]) : glm::vec2(0.0f);
    if (glm::length(here - there) > 0.5f) where.push_back(static_cast<int>(i));
  }
  return where;
}

float MotionTrial::median_length(const MotionReading& best, const MotionReading* other) const {
  std::vector<float> lengths;
  for (const RawVector& vector : best.backward ? now_vectors_ : before_vectors_) {
    const glm::vec2 there = other != nullptr ? apply(*other, vector) : glm::vec2(0.0f);
    lengths.push_back(glm::length(apply(best, vector) - there));
  }
  return median(std::move(lengths));
}

float MotionTrial::raw_length(int pair, bool backward) const {
  std::vector<float> lengths;
  for (const RawVector& vector : backward ? now_vectors_ : before_vectors_) {
    lengths.push_back(glm::length(vector.pair[pair]));
  }
  return median(std::move(lengths));
}

MotionTrials::MotionTrials(std::span<const RawGuides> frames, int count) {
  for (std::size_t i = 1; i < frames.size(); ++i) {
    trials_.emplace_back(frames[i - 1], frames[i], count);
  }
}

bool MotionTrials::has_pair(int pair) const {
  return std::all_of(trials_.begin(), trials_.end(),
                     [&](const MotionTrial& trial) { return trial.has_pair(pair); });
}

double MotionTrials::residual(const MotionReading& reading) const {
  double sum = 0.0;
  int pixels = 0;
  for (const MotionTrial& trial : trials_) {
    const int count = trial.count(reading.backward);
    sum += trial.mismatch(reading).residual * count;
    pixels += count;
  }
  return pixels > 0 ? sum / pixels : 1.0;
}

MotionContest MotionTrials::contest(const MotionReading& best, const MotionReading* other) const {
  MotionContest contest;
  const bool same_frame = other == nullptr || other->backward == best.backward;
  double best_sum = 0.0, other_sum = 0.0;
  int all = 0;
  for (const MotionTrial& trial : trials_) {
    const std::vector<int> where = trial.differing(best, other);
    all += trial.count(best.backward);
    if (where.empty()) continue;
    const int count = static_cast<int>(where.size());
    contest.pixels += count;
    best_sum += count * (same_frame ? trial.mismatch(best, where) : trial.mismatch(best)).residual;
    if (other == nullptr) {
      other_sum += count * trial.still(best, where).residual;
    } else {
      const Mismatch there = same_frame ? trial.mismatch(*other, where) : trial.mismatch(*other);
      other_sum += count * there.residual;
    }
  }
  if (contest.pixels == 0) return contest;
  contest.best = best_sum / contest.pixels;
  contest.other = other_sum / contest.pixels;
  contest.share = static_cast<double>(contest.pixels) / all;
  return contest;
}

bool MotionTrials::same_pace(const MotionReading& a, const MotionReading& b, float share) const {
  return std::all_of(trials_.begin(), trials_.end(), [&](const MotionTrial& trial) {
    return trial.median_length(a, &b) <= share * trial.median_length(a, nullptr);
  });
}

float MotionTrials::raw_length(int pair, bool backward) const {
  float longest = 0.0f;
  for (const MotionTrial& trial : trials_) {
    longest = std::max(longest, trial.raw_length(pair, backward));
  }
  return longest;
}

}  // namespace eigenlight
