// Plain scene data: what a loader or a built-in scene fills, and what the renderer reads.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frame/camera.h"

namespace eigenlight {

/// Base color image: 8-bit sRGB with alpha, row 0 at v = 0 (the top, as glTF has it); repeats.
struct Texture {
  std::string name;
  Extent extent;
  std::vector<std::uint8_t> rgba;  ///< 4 bytes a pixel
};

/// A Lambertian surface, seen from both sides.
struct Material {
  std::string name;
  glm::vec3 base_color{0.5f};  ///< linear, [0, 1]; times the texture
  int texture = -1;            ///< index into Scene::textures, or -1
  float alpha_cutoff = 0.0f;   ///< texels of lower alpha are holes; 0: none
  bool thin_glass = false;     ///< rays pass, tinted by base_color
  glm::vec3 emission{0.0f};    ///< radiance of both sides
};

struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;    ///< per vertex, or empty: flat
  std::vector<glm::vec2> texcoords;  ///< per vertex, or empty
  std::vector<glm::uvec3> triangles;
  int material = 0;
};

/// One mesh placed in the world. Meshes are shared: one Embree geometry each.
struct Instance {
  int mesh = 0;
  glm::mat4 to_world{1.0f};
};

struct SunLight {
  glm::vec3 to_light{0, 1, 0};     ///< unit
  glm::vec3 irradiance{0.0f};      ///< on a surface that faces it
  float angular_diameter = 0.53f;  ///< degrees
};

/// Emits from the side of cross(half_u, half_v) only. Not part of the meshes: the renderer adds it.
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

/// All lights at one moment. Emissive triangles keep their radiance in Material::emission; it is
/// multiplied by emissive_scale here, so that light may change without touching materials.
struct Lights {
  std::vector<SunLight> suns;
  glm::vec3 sky{0.0f};  ///< radiance from every direction that leaves the scene
  std::vector<AreaRect> rects;
  std::vector<SphereLight> spheres;
  float environment_scale = 1.0f;  ///< of Scene::environment
  glm::vec3 emissive_scale{1.0f};
  /// Emissive triangles shine (1 + dot(d, emissive_tilt)) times as bright towards d; |tilt| <= 1.
  /// A lamp that swings without moving its geometry; 0 is a plain diffuse emitter.
  glm::vec3 emissive_tilt{0.0f};
};

struct CameraKey {
  float seconds = 0.0f;
  glm::vec3 eye{0.0f}, look_at{0, 0, 1};
};

struct Scene {
  std::string name, title;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;  ///< object id of a hit: index + 1
  std::vector<Material> materials;
  std::vector<Texture> textures;
  Lights lights;
  std::optional<Environment> environment;
  std::vector<CameraKey> camera_path;  ///< at least one, seconds ascending
  float fov_y = 45.0f;                 ///< degrees
  glm::vec3 up{0, 1, 0};
  float exposure = 1.0f;     ///< for pictures to look at, never for metrics
  int missing_textures = 0;  ///< could not be read; grey stands in
};

/// The scene at one frame.
struct SceneState {
  Camera camera;
  Lights lights;
  /// World transforms of the last poses.size() instances; those before them never move.
  std::vector<glm::mat4> poses;
};

/// A scene over time: a function of the frame number alone, so that any frame can be rendered
/// alone.
class Animation {
 public:
  virtual ~Animation() = default;
  [[nodiscard]] virtual SceneState state(int frame) const = 0;
};

}  // namespace eigenlight
