// `eigenlight scenes` and `eigenlight methods [--parts]`.
#pragma once

#include <ostream>

namespace eigenlight {

/// Built-in scenes, one line each.
void list_scenes(std::ostream& out);

/// Methods, one line each, with the paper they come from.
void list_methods(std::ostream& out);

/// Each method that has parts to turn off, and what happens without each of them, one line a part.
void list_parts(std::ostream& out);

}  // namespace eigenlight
