// The denoiser beside its twin in double, on a built-in scene.
#pragma once

#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "render/live_source.h"
#include "sequences/runs/flythrough.h"
#include "sequences/runs/open_scene.h"
#include "sequences/stress/eigen_state.h"
#include "tests/reference/pipeline/eigen_twin.h"

namespace eigenlight {

/// Hands frames and samples on, and keeps the samples.
class PrecisionSource final : public FrameSource {
 public:
  PrecisionSource(FrameSource& source, Extent extent)
      : source_(source), extra_(extent), mean_(make_planes<3>(extent)) {}

  [[nodiscard]] bool next(Frame& frame) override {
    extra_.fill(0);
    return source_.next(frame);
  }
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override {
    if (!source_.resample(extra, frame, means)) return false;
    extra_ = extra.clone();
    copy_planes(*means[0], mean_);
    return true;
  }
  [[nodiscard]] const Plane<std::uint8_t>& extra() const { return extra_; }
  [[nodiscard]] const Planes<3>& mean() const { return mean_; }

 private:
  FrameSource& source_;
  Plane<std::uint8_t> extra_;
  Planes<3> mean_;
};

struct PrecisionScene {
  std::string name;
  Perturbation perturbation = Perturbation::kNone;
  Extent extent{64, 36};
  int frames = 500;
};

class PrecisionRun {
 public:
  static constexpr int kBases = 3;

  explicit PrecisionRun(const PrecisionScene& scene)
      : extent_(scene.extent),
        scene_(open_scene({scene.name}, notes_)),
        animation_(make_flythrough(scene_, scene.perturbation, extent_)),
        frames_(static_cast<std::size_t>(scene.frames)),
        live_(scene_, *animation_, render_options(),
              (std::iota(frames_.begin(), frames_.end(), 0), frames_)),
        source_(live_, extent_),
        fast_({extent_, kBases}),
        twin_(extent_, kBases),
        slots_(kBases) {}

  /// Largest |fast - twin| / max(twin, 0.1 % of the picture's mean) over all values of the next
  /// frame; negative at the end.
  [[nodiscard]] double step() {
    const Planes<3>* picture = fast_.step(source_);
    if (picture == nullptr) return -1.0;
    EigenState state(extent_, kBases);
    state.take(fast_);
    twin::Given given{fast_.frame(), fast_.report().cut, source_.extra(), source_.mean(), 0, {}};
    for (int k = 1; k < kBases; ++k) {
      const bool was = slots_[static_cast<std::size_t>(k)] && !given.cut;
      const bool is = slots_[static_cast<std::size_t>(k)] = state.memory.is_used(k);
      if (is && !was) given.newborn = k;
      if (!is && was) given.retired.push_back(k);
    }
    births_ += given.newborn > 0 ? 1 : 0;
    return difference(*picture, twin_.step(given));
  }
  /// Bases born so far.
  [[nodiscard]] int births() const { return births_; }

 private:
  [[nodiscard]] RenderOptions render_options() const {
    RenderOptions options;
    options.extent = extent_;
    options.spp = 3;
    options.direct_spp = 1;
    return options;
  }

  [[nodiscard]] static double difference(const Planes<3>& fast,
                                         const reference::AtrousImage& twin) {
    double sum = 0.0, largest = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (const double value : twin.values[c]) sum += std::abs(value);
    }
    const double floor = 1e-3 * sum / (3.0 * static_cast<double>(twin.extent.pixels())) + 1e-30;
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < twin.extent.height; ++y) {
        for (int x = 0; x < twin.extent.width; ++x) {
          const double wanted = twin.values[c][twin.index(x, y)];
          const double off = std::abs(static_cast<double>(fast[c](x, y)) - wanted) /
                             std::max(std::abs(wanted), floor);
          if (!(off <= largest)) largest = off;
          if (std::isnan(off)) return off;
        }
      }
    }
    return largest;
  }

  Extent extent_;
  std::vector<std::string> notes_;
  Scene scene_;
  std::unique_ptr<Animation> animation_;
  std::vector<int> frames_;
  LiveSource live_;
  PrecisionSource source_;
  EigenDenoiser fast_;
  twin::EigenTwin twin_;
  std::vector<bool> slots_;  // in use after the last frame
  int births_ = 0;
};

}  // namespace eigenlight
