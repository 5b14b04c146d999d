#include "sequences/denoise/sum_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "frame/bad_file.h"
#include "frame/frame.h"

namespace eigenlight {
namespace {

bool is_constant(const std::vector<RawFrame>& frames, const FileLayer& layer, float value) {
  const auto holds = [value](const Plane<float>& plane) {
    for (int y = 0; y < plane.height(); ++y) {
      const float* row = plane.row(y);
      if (std::any_of(row, row + plane.width(), [=](float v) { return v != value; })) return false;
    }
    return true;
  };
  return std::all_of(frames.begin(), frames.end(), [&](const RawFrame& frame) {
    const LayerPlanes& planes = frame.at(layer);
    return std::all_of(planes.begin(), planes.end(), holds);
  });
}

void set_row(LayerPlan& plan, const FileLayer& layer, std::string_view use, std::string_view why) {
  for (PlanRow& row : plan.rows) {
    if (row.layer != name_for_people(layer)) continue;
    row.use = use;
    row.why = why;
  }
}

void drop_absent(const std::vector<RawFrame>& frames, ViewPlan& view, LayerPlan& plan) {
  std::vector<std::size_t> place(view.lights.size(), 0);
  std::vector<PlannedLight> kept;
  for (std::size_t i = 0; i < view.lights.size(); ++i) {
    const FileLayer& layer = *view.lights[i].layer;
    const bool is_one = view.lights[i].is_alpha && is_constant(frames, layer, 1.0f);
    const bool is_absent = is_one || is_constant(frames, layer, 0.0f);
    place[i] = is_absent ? view.lights.size() : kept.size();
    if (is_absent) {
      set_row(plan, layer, "copied", is_one ? "constant 1" : "constant 0");
    } else {
      kept.push_back(view.lights[i]);
    }
  }
  for (PlannedSum& sum : view.sums) {
    std::vector<std::size_t> lights;
    for (const std::size_t light : sum.lights) {
      if (place[light] < view.lights.size()) lights.push_back(place[light]);
    }
    sum.lights = std::move(lights);
  }
  view.lights = std::move(kept);
}

// A guide that is 0 everywhere tells nothing; some renderers leave one so where a filter of another
// layer is on. Vectors of 0 are those of what stands still.
void drop_empty_guides(const std::vector<RawFrame>& frames, ViewPlan& view, LayerPlan& plan,
                       std::vector<std::string>& notes) {
  for (std::optional<FileLayer>* guide :
       {&view.albedo, &view.normal, &view.depth, &view.position}) {
    if (!*guide || !is_constant(frames, **guide, 0.0f)) continue;
    const std::string name = name_for_people(**guide);
    notes.push_back(fmt::format("{}: 0 everywhere, so it is not used as a guide", name));
    set_row(plan, **guide, "copied", "constant 0");
    guide->reset();
  }
}

// All layers of light are 0: the beauty is all there is.
void denoise_whole(ViewPlan& view, LayerPlan& plan) {
  if (!view.beauty) {
    throw BadFile(
        "all layers of light are 0, and there is no beauty; say what to denoise with "
        "--map beauty=LAYER");
  }
  view.sums.clear();
  view.emission.clear();
  view.lights.push_back({"beauty", view.beauty, view.albedo, false, true});
  set_row(plan, *view.beauty, "denoised", "all layers of light are 0: as one layer");
}

// A sum that is not the sum of its parts is denoised for itself.
void separate(ViewPlan& view, std::size_t sum, const std::string& why, LayerPlan& plan) {
  const FileLayer layer = view.sums[sum].layer;
  view.sums.erase(view.sums.begin() + static_cast<std::ptrdiff_t>(sum));
  if (view.lights.size() >= kMaxLights) {
    set_row(plan, layer, "copied", why + "; no layer of light is left for it");
    return;
  }
  view.lights.push_back({"beauty", layer, view.albedo, false, true});
  set_row(plan, layer, "denoised", why);
}

void refine_sum(const RawFrame& frame, ViewPlan& view, std::size_t index, LayerPlan& plan,
                std::vector<std::string>& notes) {
  const PlannedSum& sum = view.sums[index];
  const SumCheck found = check_sum(view, sum, frame);
  notes.push_back(fmt::format("{}: parts add up to {:.2f} % of it, off by {:.2f} % per pixel",
                              name_for_people(sum.layer), 100.0 * (1.0 - found.mean),
                              100.0 * found.absolute));
  const bool is_complete =
      found.absolute <= kRoundingAbsolute && std::abs(found.mean) <= kRoundingMean;
  if (is_complete) return;
  if (found.mean < -kRoundingMean) {
    return separate(view, index, "less than its parts: as a layer of its own", plan);
  }
  const bool is_beauty = view.beauty && key_of(*view.beauty) == key_of(sum.layer);
  if (!is_beauty) return separate(view, index, "not the sum of its parts", plan);
  if (view.lights.size() >= kMaxLights) {
    notes.push_back(fmt::format("{}: what it has beyond its parts passes as it is",
                                name_for_people(sum.layer)));
    return;
  }
  view.sums[index].lights.push_back(view.lights.size());
  view.lights.push_back({"rest of beauty", std::nullopt, std::nullopt, false});
  notes.push_back(fmt::format("{}: what it has beyond its parts is denoised as a layer of its own",
                              name_for_people(view.sums[index].layer)));
}

}  // namespace

const Plane<float>& channel_of(const LayerPlanes& planes, int channel) {
  return planes[planes.size() < 3 ? 0 : static_cast<std::size_t>(channel)];
}

LightChannel light_channel(const PlannedLight& light, const RawFrame& frame, int channel) {
  LightChannel found;
  if (light.layer) found.value = &channel_of(frame.at(*light.layer), channel);
  if (light.color) found.color = &channel_of(frame.at(*light.color), channel);
  found.is_divided = light.is_divided;
  return found;
}

SumChannels sum_channels(const ViewPlan& view, const PlannedSum& sum, const RawFrame& frame,
                         int channel) {
  SumChannels found;
  found.whole = &channel_of(frame.at(sum.layer), channel);
  found.is_beauty = view.beauty && key_of(*view.beauty) == key_of(sum.layer);
  for (const std::size_t i : sum.lights) {
    found.lights.push_back(light_channel(view.lights[i], frame, channel));
  }
  if (!found.is_beauty) return found;
  for (const FileLayer& layer : view.emission) {
    found.emission.push_back(&channel_of(frame.at(layer), channel));
  }
  return found;
}

SumOfParts parts_at(const SumChannels& in, int x, int y) {
  SumOfParts sum;
  const auto add = [&](double part) { sum.value += part, sum.size += std::abs(part); };
  for (std::size_t i = 0; i < in.lights.size(); ++i) {
    const Plane<float>* value = in.lights[i].value;
    if (value) add(static_cast<double>((*value)(x, y)) * static_cast<double>(in.weight(i, x, y)));
  }
  for (const Plane<float>* plane : in.emission) add(static_cast<double>((*plane)(x, y)));
  return sum;
}

SumCheck check_sum(const ViewPlan& view, const PlannedSum& sum, const RawFrame& frame) {
  std::array<double, 3> total{};  // of (sum - parts), of its absolute, of |sum|
  for (int c = 0; c < 3; ++c) {
    const SumChannels in = sum_channels(view, sum, frame, c);
    for (int y = 0; y < in.whole->height(); ++y) {
      for (int x = 0; x < in.whole->width(); ++x) {
        const double parts = parts_at(in, x, y).value;
        const double value = static_cast<double>((*in.whole)(x, y));
        if (!std::isfinite(parts) || !std::isfinite(value)) continue;
        total[0] += value - parts;
        total[1] += std::abs(value - parts);
        total[2] += std::abs(value);
      }
    }
  }
  if (total[2] == 0.0) return {};
  return {total[0] / total[2], total[1] / total[2]};
}

void refine_plan(const std::vector<RawFrame>& frames, LayerPlan& plan,
                 std::vector<std::string>& notes) {
  for (ViewPlan& view : plan.views) {
    drop_absent(frames, view, plan);
    drop_empty_guides(frames, view, plan, notes);
    const bool has_light = std::any_of(view.lights.begin(), view.lights.end(),
                                       [](const PlannedLight& light) { return !light.is_alpha; });
    if (!has_light) {
      denoise_whole(view, plan);
      continue;
    }
    for (std::size_t i = view.sums.size(); i-- > 0;) {
      refine_sum(frames.front(), view, i, plan, notes);
    }
  }
}

}  // namespace eigenlight
