// Frames on their way from the reader to the denoiser.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "frame/frame.h"
#include "sequences/denoise/raw_frame.h"

namespace eigenlight {

/// A frame that was read and converted, for each view.
struct ReadyFrame {
  std::shared_ptr<const RawFrame> raw;
  std::vector<std::unique_ptr<Frame>> views;
  double read_ms = 0.0;  ///< wall clock
};

/// Hands the denoiser the frame that was read for it.
class ReadySource final : public FrameSource {
 public:
  void set(Frame* frame) { frame_ = frame; }
  [[nodiscard]] bool next(Frame& frame) override {
    if (!frame_) return false;
    std::swap(frame, *frame_);
    return true;
  }
  [[nodiscard]] bool resample(const Plane<std::uint8_t>&, FrameInput&,
                              std::span<Planes<3>* const>) override {
    return false;
  }

 private:
  Frame* frame_ = nullptr;
};

}  // namespace eigenlight
