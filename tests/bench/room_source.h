// Replays the frames of a lap through the room, and knows how much time that took.
#pragma once

#include <utility>

#include "temporal/stage_clock.h"
#include "tests/bench/room.h"

namespace eigenlight {

class RoomSource final : public FrameSource {
 public:
  explicit RoomSource(const RoomLap& lap) : lap_(lap) {}

  [[nodiscard]] bool next(Frame& frame) override {
    StageClock clock;
    const Frame& stored = current();
    frame.resize(lap_.extent);
    frame.index = index_;
    frame.previous_index = index_ - 1;
    frame.is_static = false;
    frame.spp = RoomLap::kSamples;
    frame.camera = stored.camera;
    frame.surface.depth.copy_from(stored.surface.depth);
    frame.surface.id.copy_from(stored.surface.id);
    copy_planes(stored.surface.normal, frame.surface.normal);
    copy_planes(stored.surface.albedo, frame.surface.albedo);
    copy_planes(stored.indirect, frame.indirect);
    copy_planes(stored.motion, frame.motion);
    frame.previous_depth.copy_from(stored.previous_depth);
    ++index_;
    cpu_ms_ += clock.lap().cpu_ms;
    return true;
  }

  /// The samples of a pixel nearby: noise of the right size, where it is wanted.
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, Frame& frame,
                              Planes<3>& mean) override {
    StageClock clock;
    const auto [width, height] = lap_.extent;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool wanted = extra(x, y) > 0;
        for (std::size_t c = 0; c < 3; ++c) {
          mean[c](x, y) = wanted ? frame.indirect[c]((x + 2) % width, y) : 0.0f;
        }
      }
    }
    cpu_ms_ += clock.lap().cpu_ms;
    return true;
  }

  /// CPU milliseconds spent here since the last call.
  [[nodiscard]] double take_cpu_ms() { return std::exchange(cpu_ms_, 0.0); }

 private:
  [[nodiscard]] const Frame& current() const {
    return lap_.frames[static_cast<std::size_t>(index_ % RoomLap::kFrames)];
  }

  const RoomLap& lap_;
  int index_ = 0;
  double cpu_ms_ = 0.0;
};

}  // namespace eigenlight
