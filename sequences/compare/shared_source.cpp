#include "sequences/compare/shared_source.h"

#include "temporal/stage_clock.h"

namespace eigenlight {

bool SharedSource::render() {
  StageClock clock;
  has_frame_ = live_.next(frame_);
  render_time_ = clock.lap();
  return has_frame_;
}

bool SharedSource::next(Frame& frame) {
  if (!has_frame_) return false;
  copy_frame(frame_, frame);
  live_.rewind_resampling();
  return true;
}

bool SharedSource::resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                            std::span<Planes<3>* const> means) {
  return live_.resample(extra, frame, means);
}

}  // namespace eigenlight
