// Implementation of EmbreeScene: Embree handles, and which hierarchy holds which instances.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <type_traits>
#include <vector>

#include "render/rays/embree_scene.h"
#include "render/scene/quads.h"

namespace eigenlight {

struct ReleaseEmbree {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <typename Handle>
using EmbreeHandle = std::unique_ptr<std::remove_pointer_t<Handle>, ReleaseEmbree>;

/// Triangles of one mesh that form one Embree geometry, with the data its filter functions read.
struct EmbreePart {
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  const Texture* texture = nullptr;  ///< its alpha cuts the holes; null: no holes
  Quads quads;
  std::vector<std::array<glm::vec2, 4>> uv;  ///< at the corners of each quad; empty: no holes
};

/// Splits `mesh` into a part without holes, which needs no filter function, and a part with holes.
/// Triangles that lie entirely in a hole are left out.
[[nodiscard]] std::vector<EmbreePart> split_by_opacity(const Scene& scene, const Mesh& mesh);
/// Makes a geometry of `part` in world space. `part` must outlive it. Throws std::runtime_error if
/// memory runs out.
[[nodiscard]] EmbreeHandle<RTCGeometry> make_quads(RTCDevice device, const Scene& scene,
                                                   EmbreePart& part, const glm::mat4& transform);
/// Throws std::runtime_error with the name of the scene if Embree has failed since the last call.
void check_embree(RTCDevice device, const Scene& scene);

/// Context of rays that collect the tint of thin glass. `embree` must be the first member (Embree
/// manual, extended contexts).
struct GlassContext {
  RTCIntersectContext embree;
  glm::vec3 tint{1.0f};
};

/// One hierarchy over some of the instances.
struct EmbreeGroup {
  struct Member {
    std::uint32_t instance = 0;
    const EmbreePart* part = nullptr;  ///< null: an Embree instance with its own hierarchy
  };
  EmbreeHandle<RTCScene> scene;
  EmbreeHandle<RTCScene> quick;  ///< the same geometries for quick rays; null: they use `scene`
  std::vector<Member> members;   ///< indexed by Embree geometry id

  [[nodiscard]] bool empty() const { return members.empty(); }
  [[nodiscard]] RTCScene for_ray(const Ray& ray) const {
    return ray.quick && quick ? quick.get() : scene.get();
  }
  void attach(RTCGeometry geometry, const Member& member);
  void commit() const;
};

struct EmbreeScene::Impl {
  /// Values derived from the transform of an instance.
  struct Placement {
    glm::mat3 normal_matrix{1.0f};
    float area_scale = 1.0f;
  };

  Impl(const Scene& s, std::size_t moving_count);
  void set_transform(std::size_t instance, const glm::mat4& transform);
  /// Converts an Embree hit.
  [[nodiscard]] QuadHit resolve(const RTCRayHit& ray, const EmbreeGroup& group) const;

  const Scene* scene;
  std::size_t first_moving;
  EmbreeHandle<RTCDevice> device;
  std::vector<std::vector<EmbreePart>> parts;                // per mesh
  std::vector<EmbreeHandle<RTCScene>> mesh_scenes;           // per mesh; null if never instanced
  std::vector<EmbreeHandle<RTCGeometry>> instance_geometry;  // per instance; null if merged
  std::vector<glm::mat4> transforms;                         // per instance
  std::vector<Placement> placements;                         // per instance
  EmbreeGroup still, moving, glass;

 private:
  [[nodiscard]] static Placement placement_of(const glm::mat4& to_world);
  void place(std::size_t instance, std::size_t uses);
  [[nodiscard]] EmbreeHandle<RTCGeometry> make_instance(int mesh, const glm::mat4& transform);
  [[nodiscard]] EmbreeHandle<RTCScene> make_scene(RTCSceneFlags flags,
                                                  RTCBuildQuality quality) const;
  [[nodiscard]] bool is_glass(int mesh) const;
};

}  // namespace eigenlight
