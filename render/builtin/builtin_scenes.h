// Scenes made by code: nothing to download, and the same bits everywhere.
#pragma once

#include <string_view>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

struct BuiltinScene {
  std::string_view name;
  std::string_view what;  ///< one line
  Scene (*make)();
};

/// All built-in scenes, in the order they are listed.
[[nodiscard]] const std::vector<BuiltinScene>& builtin_scenes();

/// Throws std::invalid_argument listing the known names if `name` is none.
[[nodiscard]] Scene make_builtin_scene(std::string_view name);

}  // namespace eigenlight
