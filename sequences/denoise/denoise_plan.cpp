#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "frame/bad_file.h"
#include "frame/check.h"
#include "sequences/denoise/denoise_run.h"
#include "sequences/denoise/memory_plan.h"
#include "sequences/denoise/sum_check.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/machine.h"

namespace eigenlight {
namespace {

// Frames that readings are found on: two steps of motion tell more than one.
constexpr std::size_t kFirstFrames = 3;

std::vector<FileLayer> layers_of(const FrameHeaders& frame) {
  std::vector<FileLayer> layers;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const std::vector<FileLayer> found =
        list_layers(frame[i].channels, frame[i].parts, static_cast<int>(i));
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

LayerPlan find_layers(const FrameHeaders& frame, const LayerChoice& choice) {
  try {
    return plan_layers(layers_of(frame), choice);
  } catch (const BadFile& error) {
    throw BadFile(fmt::format("{}: {}", frame.front().path.string(), error.what()));
  }
}

bool has_alpha(const LayerPlan& plan) {
  return std::any_of(plan.views.begin(), plan.views.end(), [](const ViewPlan& view) {
    return std::any_of(view.lights.begin(), view.lights.end(),
                       [](const PlannedLight& light) { return light.is_alpha; });
  });
}

std::vector<int> parse_cuts(const std::string& text) {
  if (text.empty()) return {};
  return parse_frame_range(text);
}

void plan_lookahead(const DenoiseSettings& settings, DenoisePlan& plan) {
  EL_CHECK(settings.lookahead >= 0 && settings.lookahead <= kMostLookahead,
           "lookahead {}: expected 0 to {}", settings.lookahead, kMostLookahead);
  const MemoryPlan memory = plan_memory(plan.layers);
  // A run that nobody limits is tried, whatever the machine has.
  const double most = settings.max_memory.empty()
                          ? std::max(0.8 * machine_memory(), memory.bytes(plan.canvas, 0))
                          : parse_memory(settings.max_memory);
  plan.lookahead = fit_lookahead(memory, plan.canvas, settings.lookahead, most);
  const double bytes = memory.bytes(plan.canvas, plan.lookahead);
  plan.notes.push_back(
      fmt::format("memory: about {:.1f} GB, {:.0f} bytes a pixel with {} frames of lookahead",
                  bytes / (1024.0 * 1024.0 * 1024.0),
                  memory.fixed + memory.per_frame * plan.lookahead, plan.lookahead));
  if (plan.lookahead < settings.lookahead) {
    plan.warnings.push_back(fmt::format("lookahead {} in place of {}: more does not fit the memory",
                                        plan.lookahead, settings.lookahead));
  }
}

}  // namespace

DenoisePlan plan_denoising(const DenoiseSettings& settings) {
  DenoisePlan plan;
  plan.frames = find_sequence(settings.files);
  plan.cuts = parse_cuts(settings.cuts);
  const std::vector<FrameHeaders> headers = read_headers(plan.frames);
  plan.layers = find_layers(headers.front(), settings.layers);
  plan.canvas = find_canvas(headers, plan.layers);
  check_layers(headers, plan.layers);
  check_canvas(plan.canvas, plan.frames);
  plan_lookahead(settings, plan);
  std::vector<RawFrame> first;
  for (std::size_t i = 0; i < std::min(kFirstFrames, plan.frames.size()); ++i) {
    first.push_back(read_raw_frame(plan.frames[i], plan.layers, plan.canvas));
  }
  refine_plan(first, plan.layers, plan.notes);
  if (const std::string line = other_primaries(headers); !line.empty()) plan.notes.push_back(line);
  if (settings.layers.denoises_alpha && !has_alpha(plan.layers)) {
    plan.notes.emplace_back(
        "alpha: none to denoise; the beauty has none, or it is the same everywhere");
  }
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
