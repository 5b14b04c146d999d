// How plan_layers() works, for the sources of this folder that share it.
#pragma once

#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/layers/layer_map.h"
#include "sequences/layers/layer_plan.h"

namespace eigenlight {

/// One call of plan_layers(): finds lights, sums, beauty and guides of each view, in this order,
/// and notes what becomes of each layer.
class LayerPlanner {
 public:
  LayerPlanner(const std::vector<FileLayer>& layers, const LayerChoice& choice);

  [[nodiscard]] LayerPlan plan();

 private:
  struct Use {
    std::string role, use, why;
  };

  void plan_view(const std::string& view);
  void find_mapped_lights(ViewPlan& plan);
  void find_lights(ViewPlan& plan);
  void limit_lights(ViewPlan& plan);
  void find_sums(ViewPlan& plan);
  void find_beauty(ViewPlan& plan);
  void find_emission(ViewPlan& plan);
  void find_alpha(ViewPlan& plan);
  void find_guides(ViewPlan& plan);
  void denoise_beauty(ViewPlan& plan);
  void add_light(ViewPlan& plan, std::size_t index, const LightName& name);
  /// The layer of a role: the one that the user named, else the best known name. Layers that have
  /// less than `channels` channels or cannot be used are passed over, and said to be copied;
  /// std::invalid_argument if the user named one. 0 channels: any layer will do.
  std::optional<std::size_t> find(const std::string& view, Role role, std::size_t channels);
  [[nodiscard]] std::optional<std::size_t> find_word(const std::string& view,
                                                     std::string_view word) const;
  [[nodiscard]] bool is_of(std::size_t index, const std::string& view) const {
    return layers_[index].view == view;
  }
  void use(std::size_t index, Use use) {
    if (uses_[index].use.empty()) uses_[index] = std::move(use);
  }
  void check_map() const;
  [[nodiscard]] static PlanRow alpha_row(const FileLayer& layer);
  [[nodiscard]] std::vector<PlanRow> rows() const;
  [[nodiscard]] std::string known_layers() const;

  const std::vector<FileLayer>& layers_;
  std::vector<MappedLayer> map_;
  std::optional<std::regex> keep_, skip_;
  bool denoises_alpha_;
  std::vector<Use> uses_;
  LayerPlan result_;
};

}  // namespace eigenlight
