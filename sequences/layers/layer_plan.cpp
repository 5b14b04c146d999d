#include "sequences/layers/layer_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "frame/bad_file.h"
#include "frame/frame.h"
#include "sequences/layers/layer_planner.h"

namespace eigenlight {

LayerPlanner::LayerPlanner(const std::vector<FileLayer>& layers, const LayerChoice& choice)
    : layers_(layers), map_(parse_map(choice.map)), denoises_alpha_(choice.denoises_alpha) {
  if (!choice.keep.empty()) keep_ = parse_regex("--keep", choice.keep);
  if (!choice.skip.empty()) skip_ = parse_regex("--skip", choice.skip);
  uses_.resize(layers.size());
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (skip_ && std::regex_search(layers[i].name, *skip_)) uses_[i] = {"-", "copied", "--skip"};
  }
}

void LayerPlanner::add_light(ViewPlan& plan, std::size_t index, const LightName& name) {
  PlannedLight light{std::string(name.what), layers_[index], std::nullopt,
                     name.is_divided,        name.is_direct, is_glossy(name.what)};
  std::optional<std::size_t> color;
  if (!name.color.empty()) color = find_word(plan.view, name.color);
  if (color && !why_unusable(layers_[*color], 3).empty()) color.reset();
  if (!color && !name.is_divided && !name.color.empty()) color = find(plan.view, Role::kAlbedo, 3);
  if (color && layers_[index].size() >= 3) {
    light.color = layers_[*color];
    use(*color, {"color", "guide", fmt::format("of {}", name.what)});
  }
  // Without its color it cannot be composed; as it stands it still is light.
  if (name.is_divided && !light.color) light.is_divided = false;
  use(index, {"light", "denoised", std::string(name.what)});
  plan.lights.push_back(std::move(light));
}

void LayerPlanner::find_mapped_lights(ViewPlan& plan) {
  for (MappedLayer& mapped : map_) {
    if (mapped.role != Role::kLight) continue;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      if (!is_of(i, plan.view) || !is_called(layers_[i], mapped.layer)) continue;
      if (const std::string why = why_no_light(layers_[i]); !why.empty()) {
        throw std::invalid_argument(fmt::format("--map light={}: {}", mapped.layer, why));
      }
      mapped.is_used = true;
      const LightName* known = find_light(layer_word(layers_[i].name));
      add_light(plan, i, known ? *known : LightName{"", mapped.layer, "albedo", false, ""});
    }
  }
}

void LayerPlanner::find_lights(ViewPlan& plan) {
  // The names `diffuse` and `specular` are light for some renderers, and color or a sum for others.
  const bool is_vray = find_word(plan.view, "gi") || find_word(plan.view, "lighting") ||
                       find_word(plan.view, "globalillumination");
  std::set<std::string_view> sums;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (!is_of(i, plan.view)) continue;
    const LightName* name = find_light(layer_word(layers_[i].name));
    if (name && !name->sum.empty() && why_unusable(layers_[i], 3).empty()) sums.insert(name->sum);
  }
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const std::string word = layer_word(layers_[i].name);
    const LightName* name = find_light(word);
    if (!name || !is_of(i, plan.view) || !uses_[i].use.empty()) continue;
    if (sums.count(word) > 0 || (is_vray && word == "diffuse")) continue;
    if (keep_ && std::regex_search(layers_[i].name, *keep_)) {
      use(i, {"light", "copied", "--keep"});
    } else if (const std::string why = why_unusable(layers_[i], 3); !why.empty()) {
      use(i, {"light", "copied", why});
    } else {
      add_light(plan, i, *name);
    }
  }
}

// More layers than a frame can hold pass as they are: what they are in beauty passes with its rest.
void LayerPlanner::limit_lights(ViewPlan& plan) {
  if (plan.lights.size() <= kMaxLights) return;
  for (std::size_t i = kMaxLights; i < plan.lights.size(); ++i) {
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      if (layers_[k].name != plan.lights[i].layer->name || !is_of(k, plan.view)) continue;
      uses_[k] = {"light", "copied", fmt::format("more than {} layers of light", kMaxLights)};
    }
  }
  plan.lights.resize(kMaxLights);
}

void LayerPlanner::find_sums(ViewPlan& plan) {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (!is_of(i, plan.view) || !uses_[i].use.empty()) continue;
    if (!why_unusable(layers_[i], 3).empty()) continue;
    PlannedSum sum{layers_[i], {}};
    for (std::size_t k = 0; k < plan.lights.size(); ++k) {
      const LightName* name = find_light(layer_word(plan.lights[k].layer->name));
      if (!name || name->sum.empty() || name->sum != layer_word(layers_[i].name)) continue;
      sum.lights.push_back(k);
    }
    if (sum.lights.empty()) continue;
    use(i, {"sum", "composed", fmt::format("sum of {} layers of light", sum.lights.size())});
    plan.sums.push_back(std::move(sum));
  }
}

void LayerPlanner::denoise_beauty(ViewPlan& plan) {
  const std::size_t index = *find(plan.view, Role::kBeauty, 3);
  const auto albedo = find(plan.view, Role::kAlbedo, 3);
  PlannedLight light{"beauty", layers_[index], std::nullopt, false, true};
  if (albedo && layers_[index].size() >= 3) light.color = layers_[*albedo];
  plan.lights.push_back(std::move(light));
  use(index, {"beauty", "denoised", "no layers of light: as one layer"});
}

void LayerPlanner::find_beauty(ViewPlan& plan) {
  const auto beauty = find(plan.view, Role::kBeauty, 3);
  if (!beauty) return;
  plan.beauty = layers_[*beauty];
  if (plan.lights.empty()) {
    if (!(keep_ && std::regex_search(plan.beauty->name, *keep_))) denoise_beauty(plan);
    return;
  }
  PlannedSum sum{*plan.beauty, {}};
  for (std::size_t k = 0; k < plan.lights.size(); ++k) sum.lights.push_back(k);
  plan.sums.push_back(std::move(sum));
  use(*beauty, {"beauty", "composed", "of its parts"});
  find_emission(plan);
}

void LayerPlanner::find_emission(ViewPlan& plan) {
  for (const std::string_view word : words_of(Role::kEmission)) {
    const auto found = find_word(plan.view, word);
    if (!found || !why_unusable(layers_[*found], 3).empty()) continue;
    use(*found, {"emission", "steadied", "its edges, over time"});
    plan.emission.push_back(layers_[*found]);
  }
}

void LayerPlanner::plan_view(const std::string& view) {
  ViewPlan plan;
  plan.view = view;
  find_mapped_lights(plan);
  if (plan.lights.empty()) find_lights(plan);
  limit_lights(plan);
  find_sums(plan);
  find_beauty(plan);
  find_alpha(plan);
  find_guides(plan);
  if (!plan.lights.empty()) result_.views.push_back(std::move(plan));
}

LayerPlan LayerPlanner::plan() {
  std::vector<std::string> views;
  for (const FileLayer& layer : layers_) {
    if (std::find(views.begin(), views.end(), layer.view) == views.end()) {
      views.push_back(layer.view);
    }
  }
  for (const std::string& view : views) plan_view(view);
  check_map();
  if (result_.views.empty()) {
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      if (uses_[i].role != role_name(Role::kBeauty)) continue;
      throw BadFile(fmt::format("layer '{}': {}", name_for_people(layers_[i]), uses_[i].why));
    }
    throw BadFile(
        fmt::format("no layer of light found to denoise; say which it is with --map light=LAYER or "
                    "--map beauty=LAYER; the files have: {}",
                    known_layers()));
  }
  result_.rows = rows();
  for (const ViewPlan& view : result_.views) {
    if (view.lights.back().is_alpha) result_.rows.push_back(alpha_row(*view.lights.back().layer));
  }
  return std::move(result_);
}

LayerPlan plan_layers(const std::vector<FileLayer>& layers, const LayerChoice& choice) {
  return LayerPlanner(layers, choice).plan();
}

}  // namespace eigenlight
