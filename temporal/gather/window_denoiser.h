// Frames of other renderers, with the help of frames before and after them.
#pragma once

#include <deque>

#include "temporal/eigen/eigen_denoiser.h"
#include "temporal/gather/gather.h"

namespace eigenlight {

struct WindowOptions {
  /// [0, 64] Later frames that may help a frame, and earlier ones that its direct light is gathered
  /// from: 3 and 6 gave the same errors on two Cycles shots, 12 more.
  int ahead = 8, past = 4;
  EigenOptions eigen;  ///< its own filters are turned off
  SoftAtrousOptions pilot, filter;
  GuideWidths guides;
  GatherOptions gather;
  /// (0, 100] Standard deviations that count as the same light in the filter: of estimates over
  /// many frames, of direct light, and of pilots. Noise is skewed: light that a sample finds with a
  /// chance p is 1 / sqrt(p) deviations off.
  float sigmas = 7.0f, direct_sigmas = 5.0f, pilot_sigmas = 3.0f;

  WindowOptions();
  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Denoises frames whose guides are as noisy as their light, each with `ahead` later ones.
///
/// push() takes a frame in: EigenDenoiser makes its estimate, with one basis whose gain is a ratio
/// of sums of light (even_sums.h) and without a bound of fireflies, both of which cost light where
/// samples are few and heavy-tailed. step() brings the light of other frames to the oldest frame
/// that waits (gather.h), and filters it (soft_atrous.h).
///
/// Direct light has no estimate: its edges move over surfaces and are in no guide, and a history
/// would drag them along. It is gathered from earlier frames as well. Other light is gathered from
/// later frames, its estimate holds the earlier ones.
///
/// A frame's output depends on the frames up to `ahead` after it, and on no other later one.
class WindowDenoiser {
 public:
  /// Takes size and number of layers of `options`. Throws std::invalid_argument on bad ones.
  explicit WindowDenoiser(const DenoiserOptions& options, const WindowOptions& tuning = {});

  /// Takes the next frame in, and leaves an older frame's planes in its place. Throws
  /// std::invalid_argument on a frame of another size or number of layers.
  void push(Frame& frame);
  /// Takes in a frame before the first one to be denoised, as push() would have left it: for a run
  /// that goes on after load(), with the last `past` frames.
  void push_past(const Frame& frame);
  /// No more frames follow.
  void finish() { is_finished_ = true; }
  /// Denoises the oldest frame that waits. False where it waits for later ones, or there is none.
  [[nodiscard]] bool step();

  [[nodiscard]] int layers() const { return static_cast<int>(outputs_.size()); }
  /// What step() made of a layer of light: radiance over its color.
  [[nodiscard]] const Planes<3>& output(int layer) const {
    return outputs_[static_cast<std::size_t>(layer)];
  }
  /// Of the frame that step() denoised; the filter's time is that of all that EigenDenoiser does
  /// not do.
  [[nodiscard]] const FrameReport& report() const { return report_; }
  [[nodiscard]] int past() const { return options_.past; }

  /// The state after the last push(). It holds no frames: those that wait must be pushed again.
  void save(StateWriter& out) const { eigen_.save(out); }
  void load(StateReader& in) { eigen_.load(in); }

 private:
  struct Record {
    int index = 0, previous_index = -1;
    Plane<PackedGuide> guides;
    FrameLink back, ahead;
    std::vector<bool> is_direct;
    std::vector<LightRecord> lights;
    // Of layers that are not direct.
    std::vector<Planes<3>> estimates;
    std::vector<Plane<float>> variances, ages;
    std::vector<LightChange> changes;  // to the next frame
    FrameReport report;
  };

  Record& add_record(const Frame& frame);
  void record_estimates(Record& record);
  void link_to(Record& before, const Record& record);
  [[nodiscard]] GatherWalk walk(int direction, int frames) const;
  void start_output(const Record& record, std::size_t layer);
  void release(Record& record);
  void drop_used();

  WindowOptions options_;
  EigenDenoiser eigen_;
  LightRecorder recorder_;
  SoftAtrous filter_;
  LinkAhead link_ahead_;
  std::deque<Record> records_;
  std::size_t next_ = 0;  // of records_, to be denoised
  bool is_finished_ = false;
  // Planes that no frame needs any more.
  std::vector<Record> spare_;
  std::vector<LightRecord> spare_lights_;
  std::vector<Planes<3>> spare_estimates_;
  std::vector<Plane<float>> spare_planes_;
  FrameReport report_;
  std::vector<Planes<3>> outputs_;
  std::vector<Plane<float>> variances_;
};

}  // namespace eigenlight
