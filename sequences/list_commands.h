// `eigenlight scenes` and `eigenlight methods`.
#pragma once

#include <ostream>

namespace eigenlight {

/// Built-in scenes, one line each.
void list_scenes(std::ostream& out);

/// Methods, one line each, with the paper they come from.
void list_methods(std::ostream& out);

}  // namespace eigenlight
