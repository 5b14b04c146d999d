// Replays the frames of a lap through the room, and knows how much time that took.
#pragma once

#include <utility>

#include "frame/memory_source.h"
#include "temporal/stage_clock.h"
#include "tests/bench/room.h"

namespace eigenlight {

class RoomSource final : public FrameSource {
 public:
  enum class Laps { kOne, kForEver };

  explicit RoomSource(const RoomLap& lap, Laps laps = Laps::kForEver)
      : frames_(lap.frames, samples_nearby) {
    if (laps == Laps::kForEver) frames_.repeat();
  }

  [[nodiscard]] bool next(Frame& frame) override {
    StageClock clock;
    const bool found = frames_.next(frame);
    cpu_ms_ += clock.lap().cpu_ms;
    return found;
  }
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override {
    StageClock clock;
    const bool resampled = frames_.resample(extra, frame, means);
    cpu_ms_ += clock.lap().cpu_ms;
    return resampled;
  }

  /// CPU milliseconds spent here since the last call.
  [[nodiscard]] double take_cpu_ms() { return std::exchange(cpu_ms_, 0.0); }

 private:
  // The samples of a pixel nearby: noise of the right size, where it is wanted.
  static bool samples_nearby(const Plane<std::uint8_t>& extra, const FrameInput& frame,
                             std::span<Planes<3>* const> means) {
    const auto [width, height] = frame.extent();
    for (std::size_t layer = 0; layer < means.size(); ++layer) {
      for (int c = 0; c < 3; ++c) {
        const Plane<float>& from = frame.lights[layer].radiance[c];
        Plane<float>& mean = (*means[layer])[c];
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            mean(x, y) = extra(x, y) > 0 ? from((x + 2) % width, y) : 0.0f;
          }
        }
      }
    }
    return true;
  }

  MemorySource frames_;
  double cpu_ms_ = 0.0;
};

}  // namespace eigenlight
