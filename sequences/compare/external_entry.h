// A program among the methods of a comparison.
#pragma once

#include <filesystem>
#include <functional>

#include "sequences/compare/compare_run.h"
#include "sequences/compare/output_metrics.h"

namespace eigenlight {

/// Runs a program on frames that are rendered for all, and measures what it makes of them.
class ExternalEntry {
 public:
  /// `contender.external` names the program. Makes its folders.
  ExternalEntry(const ComparePlan& plan, const CompareGroup& group, const Contender& contender);

  /// Writes the inputs of a frame that the program takes: noisy indirect light times albedo, or the
  /// whole noisy picture.
  void add(const Frame& frame) const;
  /// As ExternalRun::run().
  [[nodiscard]] bool run(const std::function<bool()>& stops);
  void measure(const ReferenceFrame& references);
  [[nodiscard]] Cell finish(double render_ms) &&;

 private:
  ExternalRun run_;
  OutputMetrics metrics_;
  Extent extent_;
  bool is_whole_;
  std::filesystem::path pictures_;
  Cell cell_;
};

}  // namespace eigenlight
