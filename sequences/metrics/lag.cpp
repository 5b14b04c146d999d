#include "sequences/metrics/lag.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace eigenlight {
namespace {

bool is_step(const LightLevel& before, const LightLevel& after) {
  const double larger = std::max(std::abs(before.reference), std::abs(after.reference));
  const double change = std::abs(after.reference - before.reference);
  return larger > 0.0 && change >= kLeastStep * larger;
}

// Frames to the first that has reached the step, and the error on the way.
void follow(std::span<const LightLevel> from_step, Lag& lag) {
  double error = 0.0;
  int expected = from_step.front().frame;
  for (const LightLevel& level : from_step) {
    if (level.frame != expected++) return;
    error += level.relmse;
    const auto reached = lag.reached.find(level.frame);
    if (reached == lag.reached.end() || reached->second < kStepReached) continue;
    lag.frames = level.frame - from_step.front().frame;
    lag.error = error;
    return;
  }
}

}  // namespace

std::optional<Lag> measure_lag(std::vector<LightLevel> levels, int step) {
  std::sort(levels.begin(), levels.end(),
            [](const LightLevel& a, const LightLevel& b) { return a.frame < b.frame; });
  const auto found = std::find_if(levels.begin(), levels.end(),
                                  [step](const LightLevel& l) { return l.frame == step; });
  if (found == levels.end() || found == levels.begin()) return std::nullopt;
  const LightLevel &before = *std::prev(found), &after = *found;
  if (before.frame != step - 1 || !is_step(before, after) || after.reference == 0.0) {
    return std::nullopt;
  }
  const double bias = before.reference != 0.0 ? before.test / before.reference : 1.0;
  const double old_share = before.reference / after.reference;
  Lag lag;
  for (auto level = found; level != levels.end(); ++level) {
    if (level->reference == 0.0 || bias == 0.0) continue;
    const double share = level->test / level->reference / bias;
    lag.reached[level->frame] = (share - old_share) / (1.0 - old_share);
  }
  follow({found, levels.end()}, lag);
  return lag;
}

}  // namespace eigenlight
