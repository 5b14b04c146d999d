#include "sequences/denoise/memory_plan.h"

#include <cmath>
#include <set>

#include "frame/check.h"
#include "sequences/denoise/raw_frame.h"
#include "temporal/gather/window_denoiser.h"

namespace eigenlight {
namespace {

// Frames that are read, computed, composed and written at one time.
constexpr double kInFlight = 7.0;
// Of the filters, for a layer of light: pilot and output, each with its buffers.
constexpr double kFilterBytes = 2.0 * 13.0 * sizeof(float);
// Guides of a frame and its links to others.
constexpr double kGuideBytes = sizeof(PackedGuide) + 2 * sizeof(Link);
// What layers of light and their colors leave for other frames.
constexpr double kRecordBytes = sizeof(RecordedLight), kColorBytes = sizeof(PackedColor);
// Memory that was measured for a later frame, over what was counted.
constexpr double kOver = 1.15;

}  // namespace

MemoryPlan plan_memory(const LayerPlan& layers) {
  MemoryPlan plan;
  const double past = WindowOptions().past;
  for (const ViewPlan& view : layers.views) {
    double channels = 0.0, lights = 0.0;
    std::set<std::string> counted, colors;
    for (const FileLayer* layer : layers_read(view)) {
      if (counted.insert(key_of(*layer)).second) {
        channels += static_cast<double>(layer->channels.size());
      }
    }
    for (const PlannedLight& light : view.lights) {
      lights += 1.0;
      if (light.color) colors.insert(key_of(*light.color));
    }
    const double raw = 4.0 * channels, frame = 4.0 * (26.0 + 3.0 * lights);
    const double record =
        kGuideBytes + kRecordBytes * lights + kColorBytes * static_cast<double>(colors.size());
    plan.fixed +=
        kInFlight * raw + 0.5 * kInFlight * frame + kFilterBytes * lights + (1.0 + past) * record;
    plan.per_frame += kOver * (raw + record);
  }
  return plan;
}

double parse_memory(const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::string unit = text.substr(used);
  const std::string units = "KMGT";
  const std::size_t power = unit.size() == 1 ? units.find(unit) : std::string::npos;
  EL_CHECK(used > 0 && std::isfinite(value) && value > 0.0 &&
               (unit.empty() || power != std::string::npos),
           "'{}': expected memory such as 8G or 500M", text);
  return unit.empty() ? value : value * std::pow(1024.0, static_cast<double>(power + 1));
}

int fit_lookahead(const MemoryPlan& memory, const ExrWindow& canvas, int wanted, double most) {
  constexpr double kGigabyte = 1024.0 * 1024.0 * 1024.0;
  const double least = memory.bytes(canvas, 0);
  EL_CHECK(least <= most,
           "{}x{} pixels need {:.1f} GB ({:.0f} bytes a pixel) and {:.1f} GB are allowed: allow "
           "more, or denoise fewer layers of light at a time with --keep",
           canvas.width, canvas.height, least / kGigabyte, memory.fixed, most / kGigabyte);
  int lookahead = wanted;
  while (lookahead > 0 && memory.bytes(canvas, lookahead) > most) --lookahead;
  return lookahead;
}

}  // namespace eigenlight
