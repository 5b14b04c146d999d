// Runs of WindowDenoiser over analytic sources.
#pragma once

#include <vector>

#include "temporal/gather/window_denoiser.h"
#include "tests/support/analytic_source.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {

inline WindowOptions window(int ahead, int past = 4) {
  WindowOptions options;
  options.ahead = ahead;
  options.past = past;
  return options;
}

/// All frames of a source.
inline std::vector<Frame> frames_of(const AnalyticOptions& options) {
  AnalyticSource source(options);
  std::vector<Frame> frames;
  for (Frame frame; source.next(frame); frame = {}) frames.push_back(std::move(frame));
  return frames;
}

inline void push_copy(const Frame& frame, WindowDenoiser& denoiser) {
  Frame copy;  // gone behind the push: nothing of it may be needed
  copy_frame(frame, copy);
  denoiser.push(copy);
}

/// Takes out what can be denoised so far.
inline void take_outputs(WindowDenoiser& denoiser, std::vector<Planes<3>>& outputs) {
  while (denoiser.step()) {
    outputs.push_back(make_planes<3>(denoiser.output(0)[0].extent()));
    copy_planes(denoiser.output(0), outputs.back());
  }
}

/// Pushes all frames; each output is taken as soon as it is ready, or all at the end.
inline std::vector<Planes<3>> run_window(const std::vector<Frame>& frames,
                                         const WindowOptions& options, bool is_late = false) {
  WindowDenoiser denoiser(frames.front().extent(), 1, options);
  std::vector<Planes<3>> outputs;
  for (const Frame& frame : frames) {
    push_copy(frame, denoiser);
    if (!is_late) take_outputs(denoiser, outputs);
  }
  denoiser.finish();
  take_outputs(denoiser, outputs);
  return outputs;
}

}  // namespace eigenlight
