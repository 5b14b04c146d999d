// A FrameSource of frames in memory.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "frame/frame.h"

namespace eigenlight {

/// Hands out copies of frames that the caller keeps, one after the other.
class MemorySource final : public FrameSource {
 public:
  /// The form of FrameSource::resample().
  using Resample = std::function<bool(const Plane<std::uint8_t>& extra, FrameInput& frame,
                                      std::span<Planes<3>* const> means)>;

  /// `frames` must outlive this. Without `resample` the source has no further samples.
  explicit MemorySource(const std::vector<Frame>& frames, Resample resample = nullptr)
      : frames_(frames), resample_(std::move(resample)) {}

  /// For ever: behind the last frame comes the first again. Frames are numbered from 0 on, each
  /// leading to the one before, whatever numbers they have.
  void repeat() { repeats_ = true; }

  [[nodiscard]] bool next(Frame& frame) override;
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override {
    return resample_ && resample_(extra, frame, means);
  }

 private:
  const std::vector<Frame>& frames_;
  Resample resample_;
  bool repeats_ = false;
  int handed_out_ = 0;
};

/// Hands out one frame, once, and leaves the planes that it takes in exchange in its place.
class OneFrameSource final : public FrameSource {
 public:
  /// `frame` must outlive this.
  explicit OneFrameSource(Frame& frame) : frame_(&frame) {}

  [[nodiscard]] bool next(Frame& frame) override {
    if (!frame_) return false;
    std::swap(frame, *std::exchange(frame_, nullptr));
    return true;
  }
  [[nodiscard]] bool resample(const Plane<std::uint8_t>&, FrameInput&,
                              std::span<Planes<3>* const>) override {
    return false;
  }

 private:
  Frame* frame_;
};

}  // namespace eigenlight
