// The loop as a user runs it, without what brings the frames.
#pragma once

#include "temporal/eigen/eigen_denoiser.h"
#include "tests/bench/floors.h"
#include "tests/bench/room_source.h"
#include "tests/bench/setting.h"

namespace eigenlight {

/// What a whole frame moves: bases, age and variance; of this frame light, motion, previous depth
/// and G-buffer (normal, depth, id), of the one before its G-buffer; writes the same bases, age and
/// variance, the estimate, the age and the G-buffer to be kept.
[[nodiscard]] inline Work loop_work(int bases) {
  const int bytes = basis_bytes(bases) + kFloat;
  return {bytes + 16 * kFloat, bytes + 9 * kFloat};
}

/// `eigenlight` a few frames after its start.
class Loop {
 public:
  explicit Loop(const Setting& setting, RoomLight light = RoomLight::kChanging)
      : Loop(setting, setting.lap(light)) {}
  /// Frames of `lap`, which must outlive this; all of them have the same number of layers of light.
  Loop(const Setting& setting, const RoomLap& lap)
      : source_(lap),
        denoiser_({.extent = setting.extent,
                   .bases = setting.bases,
                   .layers = static_cast<int>(lap.frames.front().lights.size())}) {
    for (int i = 0; i < 2 * RoomLap::kFrames; ++i) sound_ = is_sound(*step(), setting.extent);
  }
  const Planes<3>* step() {
    StageClock clock;
    const Planes<3>* output = denoiser_.step(source_);
    cpu_ms_ = clock.lap().cpu_ms - source_.take_cpu_ms();
    return output;
  }
  [[nodiscard]] bool is_sound_at_start() const { return sound_; }
  [[nodiscard]] double cpu_ms() const { return cpu_ms_; }
  [[nodiscard]] const FrameReport& report() const { return denoiser_.report(); }

 private:
  RoomSource source_;
  EigenDenoiser denoiser_;
  bool sound_ = false;
  double cpu_ms_ = 0.0;
};

}  // namespace eigenlight
