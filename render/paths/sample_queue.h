// Samples of indirect light of many pixels, traced side by side.
#pragma once

#include <array>
#include <span>

#include "render/paths/path_tracer.h"
#include "render/paths/sample_mean.h"

namespace eigenlight {

/// Collects samples, traces them when there are enough, and adds each to its mean: those of one
/// mean in the order in which they came.
class SampleQueue {
 public:
  /// Both must outlive the queue. Rays and what is not finite are added to `counters`.
  SampleQueue(const PathTracer& tracer, RayCounters& counters)
      : tracer_(tracer), counters_(counters) {}

  /// `mean` must not move until flush().
  void add(const SurfacePoint& point, const Sampler& sampler, FiniteMean& mean) {
    paths_[size_].start(point, sampler);
    means_[size_] = &mean;
    if (++size_ == paths_.size()) flush();
  }
  void flush() {
    tracer_.indirect(std::span(paths_).first(size_), counters_.rays);
    for (std::size_t i = 0; i < size_; ++i) means_[i]->add(paths_[i].light, counters_);
    size_ = 0;
  }

 private:
  const PathTracer& tracer_;
  RayCounters& counters_;
  std::array<PathTracer::Path, PathTracer::kSideBySide> paths_;
  std::array<FiniteMean*, PathTracer::kSideBySide> means_{};
  std::size_t size_ = 0;
};

}  // namespace eigenlight
