// Scenes from files: scene.json beside a model, or a bare model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

struct SceneFileOptions {
  bool use_environment = false;  ///< take the scene's environment map in place of its suns and sky
};

/// Reads `path`: a scene.json, or a bare .gltf, .glb or .obj.
///
/// scene.json names the model (`file`), the camera (`keyframes` of t, eye, look_at;
/// `fov_y_degrees`, vertical), the `lights` (sun, sky, area_rect, sphere, emissive_material),
/// `exposure`, `thin_glass_materials` and an optional `environment`. Units and axes stay the
/// model's. A bare model gets a slow orbit that frames its bounds, a sun and a sky.
///
/// Base color is the factor times the texture; metals are Lambertian in their base color. Alpha
/// masks and blends are holes where alpha is under the cutoff (a half unless the file says so).
/// Triangles with NaN or Inf are dropped, and so are meshes in which no triangle is more than a
/// point. A texture that
/// cannot be read is replaced by grey and counted in Scene::missing_textures. `notes` gets one line
/// for each of these, and for whatever a bare model was given.
///
/// Throws std::runtime_error with one line that names file, field and what was expected.
[[nodiscard]] Scene load_scene(const std::filesystem::path& path, const SceneFileOptions& options,
                               std::vector<std::string>& notes);

}  // namespace eigenlight
