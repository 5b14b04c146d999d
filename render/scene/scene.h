// Plain scene data: loaders and built-in scenes fill it, and the renderer reads it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frame/camera.h"

namespace eigenlight {

/// Base color image in 8-bit sRGB with alpha. Row 0 is the top, at v = 0 as in glTF. Repeats.
struct Texture {
  std::string name;
  Extent extent;
  std::vector<std::uint8_t> rgba;  ///< 4 bytes per pixel
};

/// A two-sided Lambertian material.
struct Material {
  std::string name;
  glm::vec3 base_color{0.5f};  ///< linear, [0, 1]; multiplied by the texture
  int texture = -1;            ///< index into Scene::textures; -1: no texture
  float alpha_cutoff = 0.0f;   ///< there are holes where alpha is lower; 0: no holes
  bool thin_glass = false;     ///< rays pass straight through, tinted by base_color
  glm::vec3 emission{0.0f};    ///< radiance emitted by both sides
};

struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;    ///< one per vertex, or empty for flat shading
  std::vector<glm::vec2> texcoords;  ///< one per vertex, or empty
  std::vector<glm::uvec3> triangles;
  int material = 0;
};

/// A mesh placed in the world. Several instances can share one mesh.
struct Instance {
  int mesh = 0;
  glm::mat4 to_world{1.0f};
};

struct SunLight {
  glm::vec3 to_light{0, 1, 0};     ///< unit vector
  glm::vec3 irradiance{0.0f};      ///< on a surface that faces the sun
  float angular_diameter = 0.53f;  ///< degrees
};

/// A parallelogram that emits on the side of cross(half_u, half_v) only. It is not part of the
/// meshes.
struct AreaRect {
  glm::vec3 center{0.0f}, half_u{0.0f}, half_v{0.0f};
  glm::vec3 radiance{0.0f};
};

struct SphereLight {
  glm::vec3 center{0.0f};
  float radius = 1.0f;
  glm::vec3 radiance{0.0f};
};

/// Equirectangular radiance: u = 0.5 + atan2(z, x) / 2 pi, v from the top = acos(y) / pi.
struct Environment {
  Extent extent;
  std::vector<glm::vec3> radiance;
};

/// All lights of one frame. The radiance of emissive triangles is Material::emission times
/// emissive_scale, so that their light can change without changing materials.
struct Lights {
  std::vector<SunLight> suns;
  glm::vec3 sky{0.0f};  ///< radiance from every direction that leaves the scene
  std::vector<AreaRect> rects;
  std::vector<SphereLight> spheres;
  float environment_scale = 1.0f;  ///< factor of Scene::environment
  glm::vec3 emissive_scale{1.0f};
  /// Multiplies the radiance of emissive triangles towards d by 1 + dot(d, emissive_tilt), with
  /// |tilt| <= 1. It imitates a swinging lamp without moving geometry; 0 is a diffuse emitter.
  glm::vec3 emissive_tilt{0.0f};
};

struct CameraKey {
  float seconds = 0.0f;
  glm::vec3 eye{0.0f}, look_at{0, 0, 1};
};

struct Scene {
  std::string name, title;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;  ///< the object id of an instance is its index + 1
  std::vector<Material> materials;
  std::vector<Texture> textures;
  Lights lights;
  std::optional<Environment> environment;
  std::vector<CameraKey> camera_path;  ///< at least one key; seconds ascend
  float fov_y = 45.0f;                 ///< degrees
  glm::vec3 up{0, 1, 0};
  float exposure = 1.0f;     ///< for display only, never for metrics
  int missing_textures = 0;  ///< number of unreadable textures, replaced by gray
};

/// State of a scene in one frame.
struct SceneState {
  Camera camera;
  Lights lights;
  /// World transforms of the last poses.size() instances. All instances before them never move.
  std::vector<glm::mat4> poses;
};

/// State of a scene over time. It depends on the frame number only, so that any frame can be
/// rendered without the frames before it.
class Animation {
 public:
  virtual ~Animation() = default;
  [[nodiscard]] virtual SceneState state(int frame) const = 0;
};

}  // namespace eigenlight
