// Frames of other renderers, with the help of frames before and after them.
#pragma once

#include <deque>

#include "temporal/frame_report.h"
#include "temporal/gather/gather.h"

namespace eigenlight {

/// How a kind of light is gathered and filtered.
struct LightTuning {
  LightTest test;
  float sigmas;  ///< SoftLayer::sigmas
};

struct WindowOptions {
  /// [0, 64] Later frames that may help a frame, and earlier ones.
  int ahead = 8, past = 8;
  SoftAtrousOptions pilot, filter;
  GuideWidths guides;
  /// Shadows move and are sharp: little may change between frames, and the filter is narrow.
  LightTuning direct = {.test = {.soft = 6.0f}, .sigmas = 3.0f};
  /// What other surfaces reflect is smooth and has most noise: light that a sample finds with a
  /// chance p is 1 / sqrt(p) deviations off.
  LightTuning diffuse = {.test = {.tolerance = 0.2f}, .sigmas = 11.0f};
  /// Reflections are as sharp as the mirror, and move otherwise than its surface.
  LightTuning glossy = {.test = {}, .sigmas = 4.5f};
  /// > 0: GatherColor::width of colors, and of the share of samples that hit a lamp. Means over 4
  /// samples at edges differ by as much.
  float color_width = 0.2f, emission_width = 0.6f;
  float pilot_sigmas = 4.0f;  ///< (0, 100] standard deviations that count as the same light

  WindowOptions();
  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Denoises frames whose guides are as noisy as their light, each with `past` earlier and `ahead`
/// later ones.
///
/// push() takes a frame in and filters its pilots. step() brings light and colors of other frames
/// to the oldest frame that waits (gather.h), filters the light (soft_atrous.h), gives back what
/// that lost (even_light.h), and multiplies it by the steadied color over the frame's own: so the
/// product of output and the frame's color has no noise of colors.
///
/// Emission, which passes all filters, is steadied alike (record_emission()).
///
/// There is no recursive history: a frame's output depends on the frames of its window and on no
/// other, and nothing old stays. Tests of pilots replace a model of how light changes.
class WindowDenoiser {
 public:
  /// Throws std::invalid_argument on bad options, a bad size, or layers outside [1, kMaxLights].
  WindowDenoiser(Extent extent, int layers, const WindowOptions& options = {});

  /// Takes the next frame in, with its layers of emission. Throws std::invalid_argument on a frame
  /// of another size or number of layers.
  void push(const FrameInput& frame, std::span<const Planes<3>> emission = {});
  /// Takes in a frame before the first one to be denoised: a run that goes on begins with the last
  /// `past` frames.
  void push_past(const FrameInput& frame, std::span<const Planes<3>> emission = {});
  /// No more frames follow.
  void finish() { is_finished_ = true; }
  /// Denoises the oldest frame that waits. False where it waits for later ones, or there is none.
  [[nodiscard]] bool step();

  [[nodiscard]] int layers() const { return static_cast<int>(outputs_.size()); }
  /// What step() made of a layer of light: radiance over its color.
  [[nodiscard]] const Planes<3>& output(int layer) const {
    return outputs_[static_cast<std::size_t>(layer)];
  }
  /// What step() made of a layer of emission; NaN where it was not finite.
  [[nodiscard]] const Planes<3>& emission(int layer) const {
    return colors_[emission_at_ + static_cast<std::size_t>(layer)];
  }
  /// Of the frame that step() denoised.
  [[nodiscard]] const FrameReport& report() const { return report_; }
  [[nodiscard]] int past() const { return options_.past; }

 private:
  struct Record {
    int index = 0, previous_index = -1;
    Plane<PackedGuide> guides;
    FrameLink back, ahead;
    std::vector<LightTuning> tuning;  // of each layer
    std::vector<int> color_of;        // of each layer, index of colors; -1: it has none
    std::vector<LightRecord> lights;
    std::vector<ColorRecord> colors;   // of light, and then emission
    std::vector<Plane<float>> scales;  // of emission
    FrameReport report;
  };

  Record& add_record(const FrameInput& frame, std::span<const Planes<3>> emission);
  void record_colors(const FrameInput& frame, std::span<const Planes<3>> emission, Record& record);
  void count(const FrameInput& frame, Record& record) const;
  [[nodiscard]] const LightTuning& tuning_of(const NoisyLight& light) const;
  [[nodiscard]] GatherWalk walk(int direction, int frames) const;
  void gather_all(const Record& record);
  void apply_colors(const Record& record, std::size_t layer);
  void scale_emission(const Record& record);
  void drop_used();

  WindowOptions options_;
  Extent extent_;
  LightRecorder recorder_;
  SoftAtrous filter_;
  LinkAhead link_ahead_;
  std::deque<Record> records_;
  std::size_t next_ = 0;  // of records_, to be denoised
  bool is_finished_ = false;
  std::vector<Record> spare_;  // whose planes can be used again
  FrameReport report_;
  std::vector<Planes<3>> outputs_, colors_;
  std::size_t emission_at_ = 0;  // of colors_
  std::vector<Plane<float>> variances_;
};

}  // namespace eigenlight
