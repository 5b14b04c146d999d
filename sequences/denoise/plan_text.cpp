#include "sequences/denoise/plan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sequences/files/frame_range.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

std::vector<int> numbers(const DenoisePlan& plan) {
  std::vector<int> frames;
  for (const FrameFiles& frame : plan.frames) frames.push_back(frame.frame);
  return frames;
}

}  // namespace

std::string to_text(const DenoisePlan& plan) {
  std::size_t layer = 5, use = 3, why = 3;
  for (const PlanRow& row : plan.layers.rows) {
    layer = std::max(layer, row.layer.size());
    use = std::max(use, row.use.size());
    why = std::max(why, row.why.size());
  }
  std::string text = fmt::format("{} frames, {} to {}; {}x{} pixels at ({}, {})\n\n",
                                 plan.frames.size(), plan.frames.front().inputs.front().string(),
                                 plan.frames.back().inputs.front().string(), plan.canvas.width,
                                 plan.canvas.height, plan.canvas.x, plan.canvas.y);
  text += fmt::format("{:<9} {:<{}}  {:<5} {:<6} {:<{}}  {}\n", "role", "layer", layer, "part",
                      "type", "use", use, "why");
  for (const PlanRow& row : plan.layers.rows) {
    std::string line = fmt::format("{:<9} {:<{}}  {:<5} {:<6} {:<{}}  {}", row.role, row.layer,
                                   layer, row.part, row.type, row.use, use, row.why);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  text += '\n';
  for (const std::string& note : plan.notes) text += note + '\n';
  for (const std::string& warning : plan.warnings) text += "warning: " + warning + '\n';
  return text;
}

std::string to_json(const DenoisePlan& plan) {
  Json json;
  json["frames"] = format_frame_range(numbers(plan));
  json["first"] = plan.frames.front().inputs.front().string();
  json["last"] = plan.frames.back().inputs.front().string();
  json["canvas"] = {{"x", plan.canvas.x},
                    {"y", plan.canvas.y},
                    {"width", plan.canvas.width},
                    {"height", plan.canvas.height}};
  json["layers"] = Json::array();
  for (const PlanRow& row : plan.layers.rows) {
    json["layers"].push_back({{"role", row.role},
                              {"layer", row.layer},
                              {"part", row.part},
                              {"type", row.type},
                              {"use", row.use},
                              {"why", row.why}});
  }
  json["notes"] = plan.notes;
  json["warnings"] = plan.warnings;
  return json.dump(2) + "\n";
}

std::string to_text(const DenoiseTotals& totals) {
  std::string text = fmt::format("{} frames in {:.1f} s", totals.frames, totals.seconds);
  if (totals.frames > 0) {
    text += fmt::format(", {:.2f} s a frame", totals.seconds / static_cast<double>(totals.frames));
  }
  text += '\n';
  if (totals.skipped > 0) text += fmt::format("left as they were: {} frames\n", totals.skipped);
  for (const auto& [light, count] : totals.not_finite) {
    text += fmt::format("{}: {} pixels with NaN or Inf left out\n", light, count);
  }
  if (totals.clamped > 0) {
    text += fmt::format("{} values beyond the range of half written as 65504\n", totals.clamped);
  }
  for (const std::string& note : totals.notes) text += note + '\n';
  return text;
}

std::string to_json(const DenoiseTotals& totals) {
  Json json;
  json["frames"] = totals.frames;
  json["skipped"] = totals.skipped;
  json["seconds"] = totals.seconds;
  json["clamped"] = totals.clamped;
  json["not_finite"] = totals.not_finite;
  json["notes"] = totals.notes;
  return json.dump(2) + "\n";
}

}  // namespace eigenlight
