// Checks the indices and array sizes of a scene.
#pragma once

#include "render/scene/scene.h"

namespace eigenlight {

/// Throws std::invalid_argument with the name of the first mesh, instance or material that has an
/// index out of range, or arrays of different sizes. Normals and texcoords must be empty or have
/// one entry per vertex.
void check_scene(const Scene& scene);

}  // namespace eigenlight
