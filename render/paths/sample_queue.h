// Traces samples of indirect light of many pixels side by side.
#pragma once

#include <array>
#include <span>

#include "render/paths/path_tracer.h"
#include "render/paths/sample_mean.h"

namespace eigenlight {

/// Collects samples, traces them in groups of PathTracer::kSideBySide, and adds each to its mean.
/// The samples of one mean are added in the order of add().
class SampleQueue {
 public:
  /// Both must outlive the queue. Counts rays and non-finite samples in `counters`.
  SampleQueue(const PathTracer& tracer, RayCounters& counters)
      : tracer_(tracer), counters_(counters) {}

  /// `mean` of Path::light, and `met` of Path::met if it is not null, must stay at their addresses
  /// until flush().
  void add(const SurfacePoint& point, const Sampler& sampler, FiniteMean& mean,
           FiniteMean* met = nullptr) {
    paths_[size_].start(point, sampler);
    means_[size_] = &mean;
    met_[size_] = met;
    if (++size_ == paths_.size()) flush();
  }
  void flush() {
    tracer_.indirect(std::span(paths_).first(size_), counters_.rays);
    for (std::size_t i = 0; i < size_; ++i) {
      means_[i]->add(paths_[i].light, counters_);
      if (met_[i] != nullptr) met_[i]->add(paths_[i].met, counters_);
    }
    size_ = 0;
  }

 private:
  const PathTracer& tracer_;
  RayCounters& counters_;
  std::array<PathTracer::Path, PathTracer::kSideBySide> paths_;
  std::array<FiniteMean*, PathTracer::kSideBySide> means_{}, met_{};
  std::size_t size_ = 0;
};

}  // namespace eigenlight
