// Built-in scenes, made by code: no download, and the same bits on every machine.
#pragma once

#include <string_view>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

struct BuiltinScene {
  std::string_view name;
  std::string_view what;  ///< description in one line
  Scene (*make)();
};

/// All built-in scenes in the order of listings.
[[nodiscard]] const std::vector<BuiltinScene>& builtin_scenes();

/// Builds the scene called `name`. Throws std::invalid_argument with all names if it is unknown.
[[nodiscard]] Scene make_builtin_scene(std::string_view name);

}  // namespace eigenlight
