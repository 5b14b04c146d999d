// Guides, and layers by name.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "frame/frame.h"
#include "frame/named.h"
#include "sequences/layers/layer_planner.h"

namespace eigenlight {
namespace {

constexpr std::array<std::string_view, 3> kTypes{"half", "float", "uint"};

}  // namespace

std::optional<std::size_t> LayerPlanner::find_word(const std::string& view,
                                                   std::string_view word) const {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (is_of(i, view) && uses_[i].why != "--skip" && layer_word(layers_[i].name) == word) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> LayerPlanner::find(const std::string& view, Role role,
                                              std::size_t channels) {
  const auto why_not = [&](std::size_t i) {
    if (channels == 0) return std::string();
    FileLayer layer = layers_[i];
    if (role == Role::kId) layer.type = ExrType::kHalf;  // numbers of any type tell objects apart
    return role == Role::kBeauty ? why_no_light(layer) : why_unusable(layer, channels);
  };
  for (MappedLayer& mapped : map_) {
    if (mapped.role != role) continue;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      if (!is_of(i, view) || !is_called(layers_[i], mapped.layer)) continue;
      if (const std::string why = why_not(i); !why.empty()) {
        throw std::invalid_argument(
            fmt::format("--map {}={}: {}", role_name(role), mapped.layer, why));
      }
      mapped.is_used = true;
      return i;
    }
  }
  for (const std::string_view word : words_of(role)) {
    const auto found = find_word(view, word);
    if (!found) continue;
    const std::string why = why_not(*found);
    if (why.empty()) return found;
    use(*found, {std::string(role_name(role)), "copied", why});
  }
  return std::nullopt;
}

void LayerPlanner::find_guides(ViewPlan& plan) {
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
    const auto found = find(plan.view, guide.role, guide.channels);
    if (!found) continue;
    plan.*guide.place = layers_[*found];
    use(*found, {std::string(role_name(guide.role)), "guide", ""});
  }
  plan.is_denoised_already = find(plan.view, Role::kNoisy, 0).has_value();
}

// Light is premultiplied by alpha and so is what it becomes: alpha only has to lose its own noise.
void LayerPlanner::find_alpha(ViewPlan& plan) {
  if (!denoises_alpha_ || !plan.beauty || plan.lights.empty()) return;
  const std::string alpha = plan.beauty->name.empty() ? "A" : plan.beauty->name + ".A";
  if (plan.beauty->size() < 4 || plan.lights.size() >= kMaxLights) return;
  FileLayer layer = *plan.beauty;
  layer.channels = {layer.channels[3]};
  layer.name = alpha;
  PlannedLight light;
  light.what = "alpha";
  light.layer = std::move(layer);
  light.is_direct = light.is_alpha = true;
  plan.lights.push_back(std::move(light));
}

void LayerPlanner::check_map() const {
  for (const MappedLayer& mapped : map_) {
    if (mapped.is_used || mapped.role == Role::kOther) continue;
    throw std::invalid_argument(fmt::format("--map {}={}: no such layer; the files have: {}",
                                            role_name(mapped.role), mapped.layer, known_layers()));
  }
}

PlanRow LayerPlanner::alpha_row(const FileLayer& layer) {
  return {"alpha",
          name_for_people(layer),
          fmt::format("{}:{}", layer.input, layer.part),
          std::string(kTypes[static_cast<std::size_t>(layer.type)]),
          "denoised",
          "with the weights of direct light"};
}

std::vector<PlanRow> LayerPlanner::rows() const {
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

std::string LayerPlanner::known_layers() const {
  std::vector<std::string> names;
  for (const FileLayer& layer : layers_) names.push_back(name_for_people(layer));
  return names_of(names);
}

}  // namespace eigenlight
