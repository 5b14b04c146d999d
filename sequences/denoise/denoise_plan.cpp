#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "frame/check.h"
#include "sequences/denoise/denoise_run.h"
#include "sequences/denoise/sum_check.h"
#include "sequences/files/frame_range.h"

namespace eigenlight {
namespace {

// Frames that readings are found on: two steps of motion tell more than one.
constexpr std::size_t kFirstFrames = 3;

std::vector<FileLayer> layers_of(const FrameFiles& frame) {
  std::vector<FileLayer> layers;
  for (std::size_t i = 0; i < frame.inputs.size(); ++i) {
    const ExrFile file(frame.inputs[i]);
    const std::vector<FileLayer> found = list_layers(file, static_cast<int>(i));
    layers.insert(layers.end(), found.begin(), found.end());
  }
  return layers;
}

// Pixels that the denoiser can hold; the file is to blame, not the user.
void check_canvas(const ExrWindow& canvas, const std::vector<FrameFiles>& frames) {
  EL_CHECK(canvas.width >= 1 && canvas.height >= 1 && canvas.width <= kMaxSide &&
               canvas.height <= kMaxSide,
           "{}: data windows cover {}x{} pixels: each side must be in [1, {}]",
           frames.front().inputs.front().string(), canvas.width, canvas.height, kMaxSide);
}

std::vector<int> parse_cuts(const std::string& text) {
  if (text.empty()) return {};
  return parse_frame_range(text);
}

}  // namespace

DenoisePlan plan_denoising(const DenoiseSettings& settings) {
  DenoisePlan plan;
  plan.frames = find_sequence(settings.files);
  plan.cuts = parse_cuts(settings.cuts);
  plan.layers = plan_layers(layers_of(plan.frames.front()), settings.layers);
  plan.canvas = find_canvas(plan.frames, plan.layers);
  check_canvas(plan.canvas, plan.frames);
  std::vector<RawFrame> first;
  for (std::size_t i = 0; i < std::min(kFirstFrames, plan.frames.size()); ++i) {
    first.push_back(read_raw_frame(plan.frames[i], plan.layers, plan.canvas));
  }
  refine_plan(first, plan.layers, plan.notes);
  for (const ViewPlan& view : plan.layers.views) {
    plan.readings.push_back(find_readings(first, view, plan.canvas, settings.guides,
                                          plan.frames.front().inputs.front()));
    const Readings& readings = plan.readings.back();
    const std::string prefix = view.view.empty() ? "" : view.view + ": ";
    for (const std::string& line : readings.words) plan.notes.push_back(prefix + line);
    for (const std::string& line : readings.warnings) plan.warnings.push_back(prefix + line);
  }
  return plan;
}

}  // namespace eigenlight
