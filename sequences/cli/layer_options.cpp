#include "sequences/cli/layer_options.h"

#include <CLI/CLI.hpp>
#include <string>

namespace eigenlight {

void add_layer_options(CLI::App& command, LayerChoice& layers, GuideChoice& guides,
                       std::string& cuts) {
  command
      .add_option("--map", layers.map,
                  "ROLE=LAYER: what a layer is. Roles: beauty, light, albedo, normal, depth, "
                  "position, motion, id. Several light=LAYER name all layers that are denoised")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  command.add_option("--keep", layers.keep,
                     "Regular expression: layers of light to copy as they are");
  command.add_option("--skip", layers.skip,
                     "Regular expression: layers not to look at, only to copy");
  command
      .add_option_function<std::string>(
          "--alpha",
          [&layers](const std::string& word) { layers.denoises_alpha = word == "denoise"; },
          "keep: copy the alpha of the beauty; denoise: filter it like light [keep]")
      ->check(CLI::IsMember({"keep", "denoise"}));
  command.add_option("--motion", guides.motion,
                     "What motion vectors mean: cycles, arnold, renderman, vray, optix, none, or "
                     "words such as x,-y,pixels,backward,first [found out]");
  command.add_option("--camera", guides.camera,
                     "File with a camera for each frame [NAME.camera.json beside the input]");
  command.add_option("--cuts", cuts, "Frames at which a new shot begins, such as 101,240");
}

}  // namespace eigenlight
