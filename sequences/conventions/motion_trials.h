// Readings of motion vectors on trial: what they lead to on a sample of pixels.
#pragma once

#include <span>
#include <vector>

#include "sequences/conventions/motion_reading.h"
#include "sequences/conventions/raw_guides.h"
#include "sequences/conventions/reprojection.h"

namespace eigenlight {

/// A pixel with a raw vector, both channel pairs.
struct RawVector {
  int x = 0, y = 0;
  glm::vec2 pair[2] = {glm::vec2(0.0f), glm::vec2(0.0f)};
};

/// Two successive frames and the raw vectors of both on one sample of pixels: those that move, in
/// either pair of channels, by more than a tenth of what the fastest tenth of the pixels moves by.
class MotionTrial {
 public:
  /// At most about `count` pixels, on a regular grid.
  MotionTrial(const RawGuides& before, const RawGuides& now, int count);

  [[nodiscard]] bool has_pair(int pair) const { return pair < pairs_; }
  [[nodiscard]] int count(bool backward) const {
    return static_cast<int>((backward ? now_vectors_ : before_vectors_).size());
  }

  /// How well `reading` leads from frame to frame.
  [[nodiscard]] Mismatch mismatch(const MotionReading& reading) const;
  /// The same at the pixels of `where`, as differing() returns them.
  [[nodiscard]] Mismatch mismatch(const MotionReading& reading, std::span<const int> where) const;
  /// Pixels of `best` where both readings differ by more than half a pixel. Readings of other
  /// channels or frames are compared at the same pixel. A null `other` is no motion at all.
  [[nodiscard]] std::vector<int> differing(const MotionReading& best,
                                           const MotionReading* other) const;
  /// The median length of what `best` says, and of its difference to `other`; pixels.
  [[nodiscard]] float median_length(const MotionReading& best, const MotionReading* other) const;
  /// As if nothing moved, at the pixels of `best`.
  [[nodiscard]] Mismatch still(const MotionReading& best, std::span<const int> where) const;

  /// Median raw length of a pair at the pixels that move.
  [[nodiscard]] float raw_length(int pair, bool backward) const;

 private:
  void sample(const RawGuides& frame, int count, std::vector<RawVector>& vectors) const;
  [[nodiscard]] Mismatch compare(const MotionReading& reading, std::span<const int> where, bool all,
                                 bool is_still) const;

  const RawGuides &before_, &now_;
  int pairs_;
  std::vector<RawVector> now_vectors_, before_vectors_;
};

/// Two readings, at the pixels of the first where they differ; over all pixels if they belong to
/// different frames.
struct MotionContest {
  double best = 1.0, other = 1.0;  ///< residuals
  int pixels = 0;
  double share = 0.0;  ///< of the pixels on trial
};

/// The trials of all pairs of successive frames.
class MotionTrials {
 public:
  /// At most about `count` pixels of each frame.
  MotionTrials(std::span<const RawGuides> frames, int count);

  [[nodiscard]] bool has_pair(int pair) const;
  [[nodiscard]] double residual(const MotionReading& reading) const;
  /// A null `other` is no motion at all.
  [[nodiscard]] MotionContest contest(const MotionReading& best, const MotionReading* other) const;
  /// Whether both say the same motion, in the median, but for `share` of its length.
  [[nodiscard]] bool same_pace(const MotionReading& a, const MotionReading& b, float share) const;
  [[nodiscard]] float raw_length(int pair, bool backward) const;

 private:
  std::vector<MotionTrial> trials_;
};

}  // namespace eigenlight
