// One rendering for many methods.
#pragma once

#include "frame/frame.h"
#include "render/live_source.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Renders each frame once and hands it to as many methods as ask for it, each of which gets the
/// bits that a LiveSource of its own would give, extra samples included.
class SharedSource final : public FrameSource {
 public:
  /// `live` must outlive this.
  explicit SharedSource(LiveSource& live) : live_(live) {}

  /// Renders the next frame. False at the end of the sequence.
  [[nodiscard]] bool render();
  /// The frame that render() rendered last, before any resampling.
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// Where it comes from, with the samples that the method at hand has asked for.
  [[nodiscard]] const LiveSource& live() const { return live_; }
  /// What the last render() took.
  [[nodiscard]] const StageTime& render_time() const { return render_time_; }

  /// A copy of the frame that render() rendered last, however often it is asked for. False before
  /// the first.
  [[nodiscard]] bool next(Frame& frame) override;
  /// Of the method that called next() last.
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override;

 private:
  LiveSource& live_;
  Frame frame_;
  StageTime render_time_;
  bool has_frame_ = false;
};

/// Hands the frame of a shared source to one method, once. A method that asks for a second frame
/// within one step reads ahead and needs a source of its own.
class SingleFrameSource final : public FrameSource {
 public:
  /// `shared` must outlive this.
  explicit SingleFrameSource(SharedSource& shared) : shared_(shared) {}

  /// False, as at the end of a sequence, from the second call on.
  [[nodiscard]] bool next(Frame& frame) override { return ++calls_ == 1 && shared_.next(frame); }
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override {
    return shared_.resample(extra, frame, means);
  }
  [[nodiscard]] bool was_read_ahead() const { return calls_ > 1; }

 private:
  SharedSource& shared_;
  int calls_ = 0;
};

}  // namespace eigenlight
