// Whether the indices of a scene point at something.
#pragma once

#include "render/scene/scene.h"

namespace eigenlight {

/// Throws std::invalid_argument naming the first mesh, instance or material whose index is out of
/// range, or whose arrays do not fit together (normals and texcoords are per vertex, or empty).
void check_scene(const Scene& scene);

}  // namespace eigenlight
