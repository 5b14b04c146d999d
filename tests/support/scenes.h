// Scenes of a few triangles with known light, and animations for them.
#pragma once

#include <array>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "frame/camera.h"
#include "frame/frame.h"
#include "render/live_source.h"
#include "render/scene/scene.h"

namespace eigenlight::test {

inline int add_material(Scene& scene, const glm::vec3& color,
                        const glm::vec3& emission = glm::vec3(0.0f)) {
  Material material;
  material.base_color = color;
  material.emission = emission;
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

/// A mesh of one parallelogram, corner + [0, 1] u + [0, 1] v, with texture coordinates [0, 1]^2.
inline int add_quad_mesh(Scene& scene, int material, const std::array<glm::vec3, 3>& corner_u_v) {
  const auto& [corner, u, v] = corner_u_v;
  Mesh mesh;
  mesh.positions = {corner, corner + u, corner + u + v, corner + v};
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  scene.meshes.push_back(mesh);
  return static_cast<int>(scene.meshes.size()) - 1;
}

/// Adds the mesh and one instance of it. Returns the index of the instance.
inline int add_quad(Scene& scene, int material, const std::array<glm::vec3, 3>& corner_u_v) {
  scene.instances.push_back({add_quad_mesh(scene, material, corner_u_v), glm::mat4(1.0f)});
  return static_cast<int>(scene.instances.size()) - 1;
}

/// A horizontal square around the origin at height y.
inline int add_floor(Scene& scene, int material, float half, float y = 0.0f) {
  return add_quad(
      scene, material,
      {glm::vec3(-half, y, -half), glm::vec3(0, 0, 2 * half), glm::vec3(2 * half, 0, 0)});
}

/// The six sides of the cube [-1, 1]^3.
inline void add_cube(Scene& scene, int material) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 u(0.0f), v(0.0f), corner(-1.0f);
    u[(axis + 1) % 3] = 2.0f;
    v[(axis + 2) % 3] = 2.0f;
    add_quad(scene, material, {corner, u, v});
    corner[axis] = 1.0f;
    add_quad(scene, material, {corner, u, v});
  }
}

/// An animation from a function of the frame number.
class FunctionAnimation final : public Animation {
 public:
  explicit FunctionAnimation(std::function<SceneState(int)> state) : state_(std::move(state)) {}
  [[nodiscard]] SceneState state(int frame) const override { return state_(frame); }

 private:
  std::function<SceneState(int)> state_;
};

/// A constant view with the lights of the scene.
inline FunctionAnimation still(const Scene& scene, const Camera& camera) {
  return FunctionAnimation([lights = scene.lights, camera](int) {
    return SceneState{camera, lights, {}};
  });
}

/// Options with `spp` samples of both direct and indirect light.
inline RenderOptions render_options(Extent extent, int spp) {
  RenderOptions options;
  options.extent = extent;
  options.spp = options.direct_spp = spp;
  return options;
}

/// A camera that looks straight down at the origin from a height of 0.5.
inline Camera camera_down(Extent extent) {
  return look_at({0, 0.5f, 0}, {0, 0, 0}, {0, 0, 1}, 40.0f, extent);
}

/// The first frame of a scene from a fixed camera.
inline Frame render_still(const Scene& scene, const Camera& camera, const RenderOptions& options) {
  const FunctionAnimation animation = still(scene, camera);
  LiveSource source(scene, animation, options, {0});
  Frame frame;
  if (!source.next(frame)) throw std::logic_error("no frame");
  return frame;
}

inline glm::dvec3 mean(const Planes<3>& planes) {
  glm::dvec3 sum(0.0);
  for (int c = 0; c < 3; ++c) {
    const Plane<float>& plane = planes[static_cast<std::size_t>(c)];
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) sum[c] += static_cast<double>(plane(x, y));
    }
    sum[c] /= static_cast<double>(plane.extent().pixels());
  }
  return sum;
}

inline float at(const Planes<3>& planes, int channel, int x, int y) {
  return planes[static_cast<std::size_t>(channel)](x, y);
}

template <std::size_t N>
bool same_bits(const std::array<Plane<float>, N>& a, const std::array<Plane<float>, N>& b) {
  for (std::size_t c = 0; c < N; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      const std::size_t bytes = static_cast<std::size_t>(a[c].width()) * sizeof(float);
      if (std::memcmp(a[c].row(y), b[c].row(y), bytes) != 0) return false;
    }
  }
  return true;
}

}  // namespace eigenlight::test
