// Runs of the denoiser on analytic sources.
#pragma once

#include <functional>
#include <vector>

#include "temporal/eigen/eigen_denoiser.h"
#include "tests/support/analytic_source.h"

namespace eigenlight::test {

/// The default options without extra samples.
inline EigenOptions without_resampling() {
  EigenOptions options;
  options.budget.share = 0.0;
  return options;
}

/// The temporal part alone: no extra samples, no pixel is young, and all tiles are quiet enough to
/// skip the spatial passes.
inline EigenOptions temporal_only() {
  EigenOptions options = without_resampling();
  options.young_age = 0.0f;
  options.quiet_variance = 1.0f;
  return options;
}

using Visit = std::function<void(const Planes<3>&, const EigenDenoiser&, const AnalyticSource&)>;

/// Calls visit(output, denoiser, source) after each frame of a source.
inline void run(const AnalyticOptions& source_options, const EigenOptions& options,
                const Visit& visit) {
  AnalyticSource source(source_options);
  EigenDenoiser denoiser({source_options.extent, 3}, options);
  while (const Planes<3>* out = denoiser.step(source)) visit(*out, denoiser, source);
}

struct Pictures {
  std::vector<Planes<3>> frames;
  std::vector<FrameReport> reports;
};

/// All pictures and reports of a run.
inline Pictures run(const AnalyticOptions& source_options,
                    const EigenOptions& options = without_resampling()) {
  Pictures all;
  run(source_options, options, [&](const auto& out, const EigenDenoiser& denoiser, const auto&) {
    all.frames.push_back({out[0].clone(), out[1].clone(), out[2].clone()});
    all.reports.push_back(denoiser.report());
  });
  return all;
}

}  // namespace eigenlight::test
