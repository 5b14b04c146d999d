#include "sequences/compare/external_entry.h"

#include <utility>

#include "sequences/files/compose.h"
#include "sequences/files/file_pattern.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

fs::path make_folder(const fs::path& path) {
  fs::create_directories(path);
  return path;
}

}  // namespace

ExternalEntry::ExternalEntry(const ComparePlan& plan, const CompareGroup& group,
                             const Contender& contender)
    : run_(*contender.external, {plan.frames, plan.measured},
           make_folder(group.scratch / contender.label)),
      metrics_(metric_options(group)),
      extent_(plan.extent),
      is_whole_(plan.is_whole) {
  cell_.contender = contender.label;
  cell_.spp = group.spp;
  if (!group.pictures.empty()) pictures_ = make_folder(group.pictures / contender.label);
}

void ExternalEntry::add(const Frame& frame) const {
  if (!is_whole_) return run_.add(frame);
  if (!run_.takes(frame.index)) return;
  Planes<3> color;
  compose(frame, frame.lights[0].radiance, color);
  run_.add({frame.index, color, frame.surface.albedo, frame.surface.normal});
}

bool ExternalEntry::run(const std::function<bool()>& stops) {
  ExternalCost cost;
  if (!run_.run(stops, cost)) return false;
  cell_.denoise_ms = cost.ms;
  cell_.memory_mb = cost.peak_mb;
  return true;
}

void ExternalEntry::measure(const ReferenceFrame& references) {
  metrics_.add(references, run_.output(references.frame, extent_));
  if (pictures_.empty()) return;
  fs::copy_file(run_.output_path(references.frame),
                pictures_ / FilePattern(kFramePattern).name(references.frame),
                fs::copy_options::overwrite_existing);
}

Cell ExternalEntry::finish(double render_ms) && {
  cell_.render_ms = render_ms;
  cell_.frames = metrics_.frames();
  cell_.bad_pixels = metrics_.bad_pixels();
  return std::move(cell_);
}

}  // namespace eigenlight
