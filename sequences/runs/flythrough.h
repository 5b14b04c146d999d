// A scene over time: camera path, and the perturbations that stress a temporal filter.
#pragma once

#include <memory>

#include "render/scene/scene.h"
#include "sequences/files/perturbation.h"

namespace eigenlight {

inline constexpr float kFramesPerSecond = 24.0f;

/// The flythrough of a scene: Catmull-Rom through the camera keys at kFramesPerSecond, there and
/// back again for ever, so that every frame number has a view. Adds the objects of
/// Perturbation::kObjects to `scene` (meshes, materials, instances), whose paths are found by probe
/// rays along the camera path. Lights: perturb_lights.h. Everything is a function of the frame
/// number alone. Throws std::invalid_argument on a scene without camera keys or triangles.
[[nodiscard]] std::unique_ptr<Animation> make_flythrough(Scene& scene, Perturbation perturbation,
                                                         Extent extent);

}  // namespace eigenlight
