#include "sequences/denoise/layer_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>
#include <stdexcept>

#include "frame/bad_file.h"
#include "frame/frame.h"
#include "frame/named.h"
#include "sequences/denoise/layer_map.h"

namespace eigenlight {
namespace {

using Layers = std::vector<FileLayer>;

class Planner {
 public:
  Planner(const Layers& layers, const LayerChoice& choice)
      : layers_(layers), map_(parse_map(choice.map)) {
    if (!choice.keep.empty()) keep_ = parse_regex("--keep", choice.keep);
    if (!choice.skip.empty()) skip_ = parse_regex("--skip", choice.skip);
    uses_.resize(layers.size());
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (skip_ && std::regex_search(layers[i].name, *skip_)) uses_[i] = {"-", "copied", "--skip"};
    }
  }

  LayerPlan plan();

 private:
  struct Use {
    std::string role, use, why;
  };

  void plan_view(const std::string& view);
  void find_mapped_lights(ViewPlan& plan);
  void find_lights(ViewPlan& plan);
  void find_sums(ViewPlan& plan);
  void find_beauty(ViewPlan& plan);
  void find_guides(ViewPlan& plan);
  void denoise_beauty(ViewPlan& plan);
  void add_light(ViewPlan& plan, std::size_t index, const LightName& name);
  std::optional<std::size_t> find(const std::string& view, Role role);
  std::optional<std::size_t> find_word(const std::string& view, std::string_view word) const;
  [[nodiscard]] bool is_of(std::size_t index, const std::string& view) const {
    return layers_[index].view == view;
  }
  void use(std::size_t index, Use use) {
    if (uses_[index].use.empty()) uses_[index] = std::move(use);
  }
  void check_map() const;
  [[nodiscard]] std::vector<PlanRow> rows() const;
  [[nodiscard]] std::string known_layers() const;

  const Layers& layers_;
  std::vector<MappedLayer> map_;
  std::optional<std::regex> keep_, skip_;
  std::vector<Use> uses_;
  LayerPlan result_;
};

std::optional<std::size_t> Planner::find_word(const std::string& view,
                                              std::string_view word) const {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (is_of(i, view) && uses_[i].why != "--skip" && layer_word(layers_[i].name) == word) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> Planner::find(const std::string& view, Role role) {
  for (MappedLayer& mapped : map_) {
    if (mapped.role != role) continue;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      if (!is_of(i, view) || !is_called(layers_[i], mapped.layer)) continue;
      mapped.is_used = true;
      return i;
    }
  }
  for (const std::string_view word : words_of(role)) {
    if (auto found = find_word(view, word)) return found;
  }
  return std::nullopt;
}

void Planner::add_light(ViewPlan& plan, std::size_t index, const LightName& name) {
  PlannedLight light{std::string(name.what), layers_[index], std::nullopt, name.is_divided};
  std::optional<std::size_t> color;
  if (!name.color.empty()) color = find_word(plan.view, name.color);
  if (!color && !name.is_divided && !name.color.empty()) color = find(plan.view, Role::kAlbedo);
  if (color && layers_[*color].size() >= 3) {
    light.color = layers_[*color];
    use(*color, {"color", "guide", fmt::format("of {}", name.what)});
  }
  // Without its color it cannot be composed; as it stands it still is light.
  if (name.is_divided && !light.color) light.is_divided = false;
  use(index, {"light", "denoised", std::string(name.what)});
  plan.lights.push_back(std::move(light));
}

void Planner::find_mapped_lights(ViewPlan& plan) {
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

void Planner::find_lights(ViewPlan& plan) {
  // The names `diffuse` and `specular` are light for some renderers, and color or a sum for others.
  const bool is_vray = find_word(plan.view, "gi") || find_word(plan.view, "lighting") ||
                       find_word(plan.view, "globalillumination");
  std::set<std::string_view> sums;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (!is_of(i, plan.view)) continue;
    const LightName* name = find_light(layer_word(layers_[i].name));
    if (name && !name->sum.empty() && why_no_light(layers_[i]).empty()) sums.insert(name->sum);
  }
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const std::string word = layer_word(layers_[i].name);
    const LightName* name = find_light(word);
    if (!name || !is_of(i, plan.view) || !uses_[i].use.empty()) continue;
    if (sums.count(word) > 0 || (is_vray && word == "diffuse")) continue;
    if (keep_ && std::regex_search(layers_[i].name, *keep_)) {
      use(i, {"light", "copied", "--keep"});
    } else if (const std::string why = why_no_light(layers_[i]); !why.empty()) {
      use(i, {"light", "copied", why});
    } else {
      add_light(plan, i, *name);
    }
  }
}

void Planner::find_sums(ViewPlan& plan) {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (!is_of(i, plan.view) || !uses_[i].use.empty() || layers_[i].size() < 3) continue;
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

void Planner::denoise_beauty(ViewPlan& plan) {
  const std::size_t index = *find(plan.view, Role::kBeauty);
  if (const std::string why = why_no_light(layers_[index]); !why.empty()) {
    throw BadFile(fmt::format("layer '{}': {}", name_for_people(layers_[index]), why));
  }
  const auto albedo = find(plan.view, Role::kAlbedo);
  PlannedLight light{"beauty", layers_[index], std::nullopt, false};
  if (albedo && layers_[*albedo].size() >= 3) light.color = layers_[*albedo];
  plan.lights.push_back(std::move(light));
  use(index, {"beauty", "denoised", "no layers of light: as one layer"});
}

void Planner::find_beauty(ViewPlan& plan) {
  const auto beauty = find(plan.view, Role::kBeauty);
  if (beauty && layers_[*beauty].size() >= 3) plan.beauty = layers_[*beauty];
  if (plan.lights.empty()) {
    if (plan.beauty && !(keep_ && std::regex_search(plan.beauty->name, *keep_))) {
      denoise_beauty(plan);
    }
    return;
  }
  if (!plan.beauty || !why_no_light(*plan.beauty).empty()) return;
  PlannedSum sum{*plan.beauty, {}};
  for (std::size_t k = 0; k < plan.lights.size(); ++k) sum.lights.push_back(k);
  plan.sums.push_back(std::move(sum));
  use(*beauty, {"beauty", "composed", "of its parts"});
  for (const std::string_view word : words_of(Role::kEmission)) {
    const auto found = find_word(plan.view, word);
    if (!found || layers_[*found].size() < 3) continue;
    use(*found, {"emission", "copied", "part of beauty without noise"});
    plan.emission.push_back(layers_[*found]);
  }
}

void Planner::find_guides(ViewPlan& plan) {
  struct Guide {
    Role role;
    std::optional<FileLayer> ViewPlan::*place;
    std::size_t channels;
  };
  constexpr std::array<Guide, 6> kGuides{{{Role::kAlbedo, &ViewPlan::albedo, 3},
                                          {Role::kNormal, &ViewPlan::normal, 3},
                                          {Role::kDepth, &ViewPlan::depth, 1},
                                          {Role::kPosition, &ViewPlan::position, 3},
                                          {Role::kMotion, &ViewPlan::motion, 2},
                                          {Role::kId, &ViewPlan::id, 1}}};
  for (const Guide& guide : kGuides) {
    const auto found = find(plan.view, guide.role);
    if (!found) continue;
    const FileLayer& layer = layers_[*found];
    // Layers that nobody asked for and that cannot be used never stop a run.
    const bool is_id = guide.role == Role::kId;
    if (layer.is_deep || layer.is_subsampled || layer.size() < guide.channels) {
      use(*found, {std::string(role_name(guide.role)), "copied", "not usable as a guide"});
      continue;
    }
    if (layer.type == ExrType::kUint && !is_id) {
      use(*found,
          {std::string(role_name(guide.role)), "copied", "integers: not usable as a guide"});
      continue;
    }
    plan.*guide.place = layer;
    use(*found, {std::string(role_name(guide.role)), "guide", ""});
  }
  plan.is_denoised_already = find(plan.view, Role::kNoisy).has_value();
}

void Planner::plan_view(const std::string& view) {
  ViewPlan plan;
  plan.view = view;
  find_mapped_lights(plan);
  if (plan.lights.empty()) find_lights(plan);
  if (plan.lights.size() > kMaxLights) {
    for (std::size_t i = kMaxLights; i < plan.lights.size(); ++i) {
      for (std::size_t k = 0; k < layers_.size(); ++k) {
        if (layers_[k].name != plan.lights[i].layer->name || !is_of(k, view)) continue;
        uses_[k] = {"light", "copied", fmt::format("more than {} layers of light", kMaxLights)};
      }
    }
    plan.lights.resize(kMaxLights);
  }
  find_sums(plan);
  find_beauty(plan);
  find_guides(plan);
  if (!plan.lights.empty()) result_.views.push_back(std::move(plan));
}

void Planner::check_map() const {
  for (const MappedLayer& mapped : map_) {
    if (mapped.is_used || mapped.role == Role::kOther) continue;
    throw std::invalid_argument(fmt::format("--map {}={}: no such layer; the files have: {}",
                                            role_name(mapped.role), mapped.layer, known_layers()));
  }
}

std::vector<PlanRow> Planner::rows() const {
  constexpr std::array<std::string_view, 3> kTypes{"half", "float", "uint"};
  std::vector<PlanRow> rows;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const FileLayer& layer = layers_[i];
    Use use = uses_[i];
    if (use.use.empty()) use = {"-", "copied", layer.is_deep ? "deep" : ""};
    rows.push_back({use.role, name_for_people(layer), fmt::format("{}:{}", layer.input, layer.part),
                    std::string(kTypes[static_cast<std::size_t>(layer.type)]), use.use, use.why});
  }
  return rows;
}

std::string Planner::known_layers() const {
  std::vector<std::string> names;
  for (const FileLayer& layer : layers_) names.push_back(name_for_people(layer));
  return names_of(names);
}

LayerPlan Planner::plan() {
  std::vector<std::string> views;
  for (const FileLayer& layer : layers_) {
    if (std::find(views.begin(), views.end(), layer.view) == views.end()) {
      views.push_back(layer.view);
    }
  }
  for (const std::string& view : views) plan_view(view);
  check_map();
  if (result_.views.empty()) {
    throw BadFile(
        fmt::format("no layer of light found to denoise; say which it is with --map light=LAYER or "
                    "--map beauty=LAYER; the files have: {}",
                    known_layers()));
  }
  result_.rows = rows();
  return std::move(result_);
}

}  // namespace

LayerPlan plan_layers(const std::vector<FileLayer>& layers, const LayerChoice& choice) {
  return Planner(layers, choice).plan();
}

}  // namespace eigenlight
