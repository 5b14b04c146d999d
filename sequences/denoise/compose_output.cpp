#include "sequences/denoise/compose_output.h"

#include <algorithm>
#include <cmath>

#include "frame/tiles.h"
#include "sequences/denoise/sum_check.h"

namespace eigenlight {
namespace {

// Where a channel's data window lies on the canvas.
struct Place {
  int dx, dy;
  Extent extent;
};

Place place_of(const ExrFile& file, int channel, const ExrWindow& canvas) {
  const int part = file.channels()[static_cast<std::size_t>(channel)].part;
  const ExrWindow& window = file.parts()[static_cast<std::size_t>(part)].data;
  return {window.x - canvas.x, window.y - canvas.y, {window.width, window.height}};
}

// Calls value(x, y) for the canvas pixels of a channel; the channel's own value stays beside it.
template <typename Value>
NewChannel fill(int channel, const Place& place, const Extent& canvas, const Value& value) {
  NewChannel out{channel, Plane<float>(place.extent)};
  parallel_for(place.extent.height, [&](int y) {
    for (int x = 0; x < place.extent.width; ++x) {
      if (!canvas.contains(x + place.dx, y + place.dy)) continue;
      out.values(x, y) = value(x + place.dx, y + place.dy);
    }
  });
  return out;
}

float value_or(float value, float other) { return std::isnan(value) ? other : value; }

// The value of a sum at one pixel.
float sum_value(const SumChannels& in, const std::vector<const Plane<float>*>& lights,
                const std::vector<const Plane<float>*>& emission, int x, int y) {
  double after = 0.0;
  bool has_rest = false;  // a layer of light holds what is beyond the parts
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const LightChannel& light = in.lights[i];
    const double weight = static_cast<double>(in.weight(i, x, y));
    after +=
        weight * static_cast<double>(light.written(x, y)) * static_cast<double>((*lights[i])(x, y));
    has_rest |= light.value == nullptr;
  }
  for (std::size_t i = 0; i < in.emission.size(); ++i) {
    const float own = (*in.emission[i])(x, y);
    after += static_cast<double>(emission.empty() ? own : value_or((*emission[i])(x, y), own));
  }
  const SumOfParts before = parts_at(in, x, y);
  const double rest = static_cast<double>((*in.whole)(x, y)) - before.value;
  const bool passes =
      !has_rest && std::isfinite(rest) && std::abs(rest) > kRoundingAbsolute * before.size;
  return static_cast<float>(passes ? after + rest : after);
}

void compose_emission(const RawFrame& frame, const FileLayer& layer, const ExrWindow& canvas,
                      const Planes<3>& steadied, std::vector<std::vector<NewChannel>>& outputs) {
  const auto input = static_cast<std::size_t>(layer.input);
  const ExrFile& file = *frame.files[input];
  const std::vector<int> channels = channel_indices(file, "", layer);
  const LayerPlanes& before = frame.at(layer);
  for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 3); ++c) {
    const Plane<float>& own = channel_of(before, static_cast<int>(c));
    outputs[input].push_back(
        fill(channels[c], place_of(file, channels[c], canvas), {canvas.width, canvas.height},
             [&](int x, int y) { return value_or(steadied[c](x, y), own(x, y)); }));
  }
}

}  // namespace

std::vector<ExrReplacement> replacements_of(std::span<const NewChannel> channels) {
  std::vector<ExrReplacement> replacements;
  for (const NewChannel& channel : channels) {
    replacements.push_back({channel.channel, &channel.values});
  }
  return replacements;
}

void compose_view(const RawFrame& frame, const ViewPlan& view, const ExrWindow& canvas,
                  std::span<const Planes<3>* const> lights,
                  std::span<const Planes<3>* const> emission,
                  std::vector<std::vector<NewChannel>>& outputs) {
  const Extent extent{canvas.width, canvas.height};
  for (std::size_t i = 0; i < view.lights.size(); ++i) {
    const PlannedLight& light = view.lights[i];
    if (!light.layer) continue;
    const auto input = static_cast<std::size_t>(light.layer->input);
    const ExrFile& file = *frame.files[input];
    const std::vector<int> channels = channel_indices(file, "", *light.layer);
    for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 3); ++c) {
      const LightChannel in = light_channel(light, frame, static_cast<int>(c));
      const Plane<float>& denoised = (*lights[i])[c];
      outputs[input].push_back(
          fill(channels[c], place_of(file, channels[c], canvas), extent, [&](int x, int y) {
            const float value = denoised(x, y) * in.written(x, y);
            return light.is_alpha ? std::clamp(value, 0.0f, 1.0f) : value;
          }));
    }
  }
  for (std::size_t i = 0; i < emission.size(); ++i) {
    compose_emission(frame, view.emission[i], canvas, *emission[i], outputs);
  }
  for (const PlannedSum& sum : view.sums) {
    const auto input = static_cast<std::size_t>(sum.layer.input);
    const ExrFile& file = *frame.files[input];
    const std::vector<int> channels = channel_indices(file, "", sum.layer);
    for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 3); ++c) {
      const SumChannels in = sum_channels(view, sum, frame, static_cast<int>(c));
      std::vector<const Plane<float>*> denoised, steadied;
      for (const std::size_t i : sum.lights) denoised.push_back(&(*lights[i])[c]);
      for (const Planes<3>* layer : emission) steadied.push_back(&(*layer)[c]);
      outputs[input].push_back(
          fill(channels[c], place_of(file, channels[c], canvas), extent,
               [&](int x, int y) { return sum_value(in, denoised, steadied, x, y); }));
    }
  }
}

}  // namespace eigenlight
