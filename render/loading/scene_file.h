// Loads scenes from files: a scene.json with its model, or a bare model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

struct SceneFileOptions {
  bool use_environment = false;  ///< replaces suns and sky by the environment map of the scene
};

/// Reads `path`: a scene.json, or a bare .gltf, .glb or .obj.
///
/// scene.json contains the model (`file`), the camera (`keyframes` of t, eye, look_at; vertical
/// `fov_y_degrees`), the `lights` (sun, sky, area_rect, sphere, emissive_material), `exposure`,
/// `thin_glass_materials` and an optional `environment`. Units and axes are those of the model. A
/// bare model gets a sun, a sky and a camera that orbits slowly and shows the whole model.
///
/// Base color is the factor times the texture; metals are Lambertian with their base color. Alpha
/// masks and blends become holes where alpha is below the cutoff, which is 0.5 by default.
/// Triangles with NaN or Inf and meshes without extent are dropped. An unreadable texture is
/// replaced by gray and counted in Scene::missing_textures. `notes` gets one line for each of these
/// changes, and one for the additions to a bare model.
///
/// Throws std::runtime_error with one line: file, field, and what was expected.
[[nodiscard]] Scene load_scene(const std::filesystem::path& path, const SceneFileOptions& options,
                               std::vector<std::string>& notes);

}  // namespace eigenlight
