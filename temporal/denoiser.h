// The interface of all denoising methods.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frame/frame.h"
#include "frame/state.h"
#include "temporal/frame_report.h"

namespace eigenlight {

class Denoiser {
 public:
  virtual ~Denoiser() = default;

  /// Pulls one frame from `source` and denoises its layers of light. Returns the first: radiance
  /// over its color, linear, 0 without surface; valid until the next call. Null at the end of the
  /// sequence. Throws std::invalid_argument if the frame has another size or number of layers than
  /// the denoiser.
  [[nodiscard]] virtual const Planes<3>* step(FrameSource& source) = 0;

  [[nodiscard]] virtual const Frame& frame() const = 0;         ///< the one that step() pulled last
  [[nodiscard]] virtual const FrameReport& report() const = 0;  ///< of the last step()
  /// Frames' worth of samples behind each pixel; 0 without surface.
  [[nodiscard]] virtual const Plane<float>& age() const = 0;

  virtual void reset() = 0;  ///< forgets all history, as at a cut

  /// Saves and restores the history between two frames. After load() the next step() gives the same
  /// bits as in a run without interruption. load() throws std::runtime_error on other data.
  virtual void save(StateWriter& out) const = 0;
  virtual void load(StateReader& in) = 0;
};

struct DenoiserOptions {
  Extent extent;
  int bases = 3;   ///< [1, 8] K, for methods that have bases
  int layers = 1;  ///< [1, kMaxLights] layers of light in each frame, for `eigenlight`
  /// Names of parts of the method to turn off, to measure what each contributes.
  std::vector<std::string> without = {};
};

/// A part of a method that can be turned off.
struct Part {
  std::string_view name;
  std::string_view what;  ///< one line: what happens without it
};

}  // namespace eigenlight
