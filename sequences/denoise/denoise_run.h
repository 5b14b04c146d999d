// Denoises a sequence of files: reading, computing and writing overlap.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sequences/denoise/compose_output.h"
#include "sequences/denoise/denoise_record.h"
#include "sequences/denoise/frame_builder.h"
#include "sequences/denoise/sequence_files.h"
#include "temporal/denoiser.h"
#include "temporal/gather/gather.h"

namespace eigenlight {

/// Most later frames that may help a frame.
inline constexpr int kMostLookahead = kMostGathered;

/// What the user asks for.
struct DenoiseSettings {
  FileChoice files;
  LayerChoice layers;
  GuideChoice guides;
  std::string cuts;        ///< frames at which a new shot begins, as parse_frame_range() takes them
  int lookahead = 8;       ///< [0, kMostLookahead] later frames that may help a frame
  std::string max_memory;  ///< as parse_memory() takes it; empty: 4/5 of the machine's
  bool skip_existing = false;        ///< frames whose outputs are complete are not written again
  bool resume = false;               ///< go on from the checkpoint of an interrupted run
  double checkpoint_seconds = 10.0;  ///< between two checkpoints, >= 0
};

/// All that is known before the first frame is denoised.
struct DenoisePlan {
  std::vector<FrameFiles> frames;
  LayerPlan layers;
  ExrWindow canvas;
  std::vector<Readings> readings;  ///< of each view
  std::vector<int> cuts;
  int lookahead = 0;  ///< as asked for, or less where memory does not suffice
  std::vector<std::string> notes, warnings;
};

/// Looks at the first frames. Throws std::invalid_argument and BadFile as its parts do.
[[nodiscard]] DenoisePlan plan_denoising(const DenoiseSettings& settings);

/// What a run did.
struct DenoiseTotals {
  std::size_t frames = 0;   ///< written by this process
  std::size_t skipped = 0;  ///< whose outputs were complete
  double seconds = 0.0;
  std::int64_t clamped = 0;                        ///< values beyond the range of half
  std::map<std::string, std::int64_t> not_finite;  ///< pixels of each layer with NaN or Inf
  std::vector<std::string> notes;                  ///< what writing changed, once each
};

/// Called by the run in the order of frames.
struct DenoiseCallbacks {
  std::function<bool()> interrupted;
  std::function<void(int frame)> frame_done;
  /// How a frame went, before it counts as done. May be empty.
  std::function<void(const DenoiseRecord&)> record = {};
};

/// Denoises all frames of a plan. Stops after the frame at hand when interrupted; files are
/// complete or absent at any time. A checkpoint beside the outputs, `.FIRST.eigenlight-state`
/// (FIRST: name of the first output), is brought up to date every checkpoint_seconds and removed at
/// the end. Throws what reading and writing throw, and CheckpointError if `resume` finds a
/// checkpoint of another run.
[[nodiscard]] DenoiseTotals run_denoising(const DenoiseSettings& settings, const DenoisePlan& plan,
                                          const DenoiseCallbacks& callbacks);

}  // namespace eigenlight
