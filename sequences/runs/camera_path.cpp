#include "sequences/runs/camera_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frame/check.h"

namespace eigenlight {
namespace {

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_keys(const std::vector<CameraKey>& keys) {
  EL_CHECK(!keys.empty(), "camera path: no keys, expected at least one");
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EL_CHECK(std::isfinite(keys[i].seconds) && finite(keys[i].eye) && finite(keys[i].look_at),
             "camera path: key {} holds NaN or Inf", i);
    EL_CHECK(i == 0 || keys[i].seconds > keys[i - 1].seconds,
             "camera path: key {} is at {} s, expected more than the {} s of the key before", i,
             keys[i].seconds, keys[i - 1].seconds);
  }
}

glm::vec3 hermite(float w, const glm::vec3& from, const glm::vec3& to, const glm::vec3& from_slope,
                  const glm::vec3& to_slope) {
  const float w2 = w * w, w3 = w2 * w;
  return from * (2 * w3 - 3 * w2 + 1) + from_slope * (w3 - 2 * w2 + w) + to * (3 * w2 - 2 * w3) +
         to_slope * (w3 - w2);
}

}  // namespace

CameraPath::CameraPath(std::vector<CameraKey> keys, float frames_per_second)
    : keys_(std::move(keys)) {
  check_keys(keys_);
  const float seconds = keys_.back().seconds - keys_.front().seconds;
  length_ = std::max(1, static_cast<int>(std::lround(seconds * frames_per_second)));
  // The path turns back at its ends, so both neighbors of an end are equal and its tangent is 0.
  tangents_.resize(keys_.size(), {glm::vec3(0.0f), glm::vec3(0.0f)});
  for (std::size_t i = 1; i + 1 < keys_.size(); ++i) {
    const CameraKey &before = keys_[i - 1], &after = keys_[i + 1];
    const float time = after.seconds - before.seconds;
    tangents_[i] = {(after.eye - before.eye) / time, (after.look_at - before.look_at) / time};
  }
}

CameraPath::View CameraPath::at(int frame) const {
  const int phase = ((frame % period()) + period()) % period();
  const int step = std::min(phase, period() - phase);
  const float start = keys_.front().seconds, end = keys_.back().seconds;
  const float seconds =
      start + (end - start) * (static_cast<float>(step) / static_cast<float>(length_));
  std::size_t next = 1;
  while (next < keys_.size() && keys_[next].seconds < seconds) ++next;
  if (next >= keys_.size()) return {keys_.back().eye, keys_.back().look_at};
  const CameraKey &from = keys_[next - 1], &to = keys_[next];
  const View &leave = tangents_[next - 1], &arrive = tangents_[next];
  const float time = to.seconds - from.seconds, w = (seconds - from.seconds) / time;
  return {hermite(w, from.eye, to.eye, leave.eye * time, arrive.eye * time),
          hermite(w, from.look_at, to.look_at, leave.look_at * time, arrive.look_at * time)};
}

}  // namespace eigenlight
