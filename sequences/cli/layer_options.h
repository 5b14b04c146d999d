// Options that say what layers and guides of EXR files are.
#pragma once

#include <string>

#include "sequences/denoise/denoise_run.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// Adds --map, --keep, --skip, --motion, --camera and --cuts, which end up in the arguments.
void add_layer_options(CLI::App& command, LayerChoice& layers, GuideChoice& guides,
                       std::string& cuts);

}  // namespace eigenlight
