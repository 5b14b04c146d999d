// run.json: what a run was.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "frame/plane.h"
#include "render/scene/scene.h"
#include "sequences/files/exr_io.h"
#include "sequences/runs/render_plan.h"

namespace eigenlight {

/// Everything that determines the bits of a run, and what a viewer needs to show it.
struct RunDescription {
  std::string scene, title;
  std::uint64_t scene_hash = 0;
  bool environment = false;
  std::vector<int> frames;
  Extent extent;
  int spp = 0, direct_spp = 0, bounces = 0;
  std::string method;
  std::string without;  ///< comma-separated parts of the method that were off
  int bases = 0;
  std::uint32_t seed = 0;
  std::string perturb;
  std::string direct = "denoised";
  std::string antialias = "none";
  std::string layers;
  float exposure = 1.0f;
};

[[nodiscard]] RunDescription describe_run(const RenderSettings& settings, const RenderPlan& plan,
                                          const Scene& scene);

/// The description as JSON text, with the program's name and version: the content of run.json.
[[nodiscard]] std::string to_json_text(const RunDescription& run);

/// The attributes that describe the run in each of its frame files.
[[nodiscard]] std::vector<ExrAttribute> file_attributes(const RunDescription& run);

/// The first difference of two texts of to_json_text(), for people: "spp is 3 there, 4 here". Empty
/// if they are equal. Throws BadFile if one is not a JSON object.
[[nodiscard]] std::string first_difference(std::string_view there, std::string_view here);

}  // namespace eigenlight
