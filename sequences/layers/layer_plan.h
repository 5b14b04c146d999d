// Which layers of the files are denoised, which guide, and which are only copied.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sequences/layers/layer_list.h"
#include "sequences/layers/layer_names.h"

namespace eigenlight {

/// What the user says about layers.
struct LayerChoice {
  std::vector<std::string> map = {};  ///< `ROLE=LAYER`
  std::string keep =
      {};  ///< regular expression: light layers of such names are copied, not denoised
  std::string skip =
      {};  ///< regular expression: layers of such names are not looked at, only copied
  bool denoises_alpha = false;  ///< filter the alpha of beauty like its light; else it is copied
};

/// A layer of light that is denoised.
struct PlannedLight {
  std::string what;                ///< "diffuse direct"
  std::optional<FileLayer> layer;  ///< where it stands; none: what beauty has beyond all parts
  std::optional<FileLayer> color;  ///< what it is multiplied by, or its albedo; none: 1
  bool is_divided = false;         ///< the file has it without `color`
  bool is_direct = false;          ///< NoisyLight::is_direct
  bool is_glossy = false;          ///< NoisyLight::is_glossy
  bool is_alpha = false;           ///< the alpha of beauty, in [0, 1]; part of no sum
};

/// A layer that is the sum of others: beauty, or diffuse of direct and indirect.
struct PlannedSum {
  FileLayer layer;
  std::vector<std::size_t> lights;  ///< of ViewPlan::lights
};

/// All that is read of one view of a frame.
struct ViewPlan {
  std::string view;
  std::optional<FileLayer> beauty;
  std::vector<PlannedLight> lights;
  std::vector<PlannedSum> sums;     ///< beauty among them, where it is composed
  std::vector<FileLayer> emission;  ///< parts of beauty that pass
  std::optional<FileLayer> albedo, normal, depth, position, motion, id;
  bool is_denoised_already = false;  ///< a layer says that the renderer denoised the beauty
};

/// One line of the table that is printed before a run.
struct PlanRow {
  std::string role, layer, part, type, use, why;
};

struct LayerPlan {
  std::vector<ViewPlan> views;
  std::vector<PlanRow> rows;
};

/// Finds the roles of `layers`, of one or several inputs. Names are matched from the right end, in
/// any case and view layer. Where direct and indirect light of a kind are there, their sum is
/// composed of them; where only a beauty is there, it is one layer of light over its albedo.
///
/// Throws std::invalid_argument if a `--map` names no role or no layer, a regular expression is
/// wrong, or a layer that it names is deep, subsampled, of integers or has too few channels;
/// BadFile naming the layers if there is no light at all. Other layers that cannot be used are
/// copied.
[[nodiscard]] LayerPlan plan_layers(const std::vector<FileLayer>& layers,
                                    const LayerChoice& choice);

}  // namespace eigenlight
