#include "sequences/metrics/figures_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Figures figures_from_json(const Json& json) {
  Figures figures;
  figures.pixels = json.at("pixels").get<std::int64_t>();
  for (std::size_t m = 0; m < kMetricCount; ++m) {
    const auto value = json.find(std::string(kMetricNames[m]));
    if (value != json.end()) figures.values[m] = value->get<double>();
  }
  return figures;
}

std::string set_name(PixelSet set) {
  return std::string(kPixelSetNames[static_cast<std::size_t>(set)]);
}

}  // namespace

Json to_json(const Figures& figures) {
  Json json = Json::object();
  for (std::size_t m = 0; m < kMetricCount; ++m) {
    const auto& value = figures.values[m];
    if (value && std::isfinite(*value)) json[std::string(kMetricNames[m])] = *value;
  }
  if (const auto energy = figures.energy()) json["energy"] = *energy;
  json["pixels"] = figures.pixels;
  return json;
}

Json to_json(const FrameFigures& frame) {
  Json json = {{"frame", frame.frame}};
  json.update(to_json(frame[PixelSet::kSurface]));
  for (const PixelSet set : {PixelSet::kYoung, PixelSet::kOld}) {
    if (frame[set].pixels > 0) json[set_name(set)] = to_json(frame[set]);
  }
  return json;
}

Json to_json(const SetFigures& sets) {
  Json json = Json::object();
  for (std::size_t s = 0; s < kPixelSetCount; ++s) {
    if (sets[s].pixels > 0) json[std::string(kPixelSetNames[s])] = to_json(sets[s]);
  }
  return json;
}

FrameFigures frame_figures_from_json(const Json& json) {
  FrameFigures frame;
  frame.frame = json.at("frame").get<int>();
  frame.sets[static_cast<std::size_t>(PixelSet::kSurface)] = figures_from_json(json);
  for (const PixelSet set : {PixelSet::kYoung, PixelSet::kOld}) {
    const auto found = json.find(set_name(set));
    if (found != json.end()) frame.sets[static_cast<std::size_t>(set)] = figures_from_json(*found);
  }
  return frame;
}

}  // namespace eigenlight
