// A scene over time: the camera path and its perturbations.
#pragma once

#include <memory>

#include "render/scene/scene.h"
#include "sequences/files/perturbation.h"

namespace eigenlight {

inline constexpr float kFramesPerSecond = 24.0f;

/// The flythrough of a scene: Catmull-Rom through the camera keys at kFramesPerSecond, back and
/// forth (camera_path.h), so that every frame number has a view. Perturbation::kObjects adds its
/// objects to `scene` (meshes, materials, instances; perturb_objects.h); lights: perturb_lights.h.
/// Everything depends on the frame number alone. Throws std::invalid_argument for a scene without
/// camera keys or triangles.
[[nodiscard]] std::unique_ptr<Animation> make_flythrough(Scene& scene, Perturbation perturbation,
                                                         Extent extent);

}  // namespace eigenlight
