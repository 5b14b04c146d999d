// All methods on the same noisy frames.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "sequences/compare/compare_cell.h"
#include "sequences/compare/compare_plan.h"
#include "sequences/compare/reference_cache.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// One rendering: a scene at one sample count, and those who are to denoise it.
struct CompareGroup {
  AnimatedScene animated;
  const ReferenceCache& references;  ///< must hold all measured frames
  int spp = 0;
  float exposure = 1.0f;  ///< of display values in PSNR and SSIM
  std::vector<const Contender*> contenders;
  /// Where the measured frames go, one folder a contender (layer `indirect`, or R,G,B of a
  /// program); empty: nowhere.
  std::filesystem::path pictures;
  std::filesystem::path scratch;  ///< for programs; made and removed
};

[[nodiscard]] MetricOptions metric_options(const CompareGroup& group);

/// CPU milliseconds of the method itself: all stages but rendering and resampling.
[[nodiscard]] double denoise_cpu_ms(const FrameReport& report);
/// Further samples that the method asked for, per surface pixel.
[[nodiscard]] double extra_samples_per_pixel(const FrameReport& report);

/// Renders the frames of the plan once and hands each to every contender, so that all see the same
/// bits, and measures those of plan.measured against both references. Methods that
/// read ahead get a source of their own after the last frame, and programs run then too. Pixels are
/// young or old by the history of the method `mean`, for all contenders alike: it knows no
/// resampling, so it counts frames since a surface came into view. Cells in the order of the
/// contenders, or nothing if it was stopped. Throws std::runtime_error naming the program or file
/// that failed.
[[nodiscard]] std::optional<std::vector<Cell>> run_group(const ComparePlan& plan,
                                                         const CompareGroup& group,
                                                         const RunControl& control);

}  // namespace eigenlight
