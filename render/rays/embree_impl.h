// What stands behind EmbreeScene: Embree's handles, and which of its hierarchies holds what.
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

/// Triangles of one mesh as one Embree geometry, and what the filters need of them.
struct EmbreePart {
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  const Texture* texture = nullptr;  ///< of the holes; null: none
  Quads quads;
  std::vector<std::array<glm::vec2, 4>> uv;  ///< of each quad's corners, if there are holes
};

/// Triangles that are nothing but hole are left out; those without holes need no filter and are a
/// part of their own.
[[nodiscard]] std::vector<EmbreePart> split_by_opacity(const Scene& scene, const Mesh& mesh);
/// `part` must outlive the geometry. Throws std::runtime_error if there is no memory.
[[nodiscard]] EmbreeHandle<RTCGeometry> make_quads(RTCDevice device, const Scene& scene,
                                                   EmbreePart& part, const glm::mat4& transform);
/// Throws std::runtime_error, with the name of the scene, if Embree has failed since it was asked
/// last.
void check_embree(RTCDevice device, const Scene& scene);

/// Of rays that gather what thin glass does to them; `embree` is the first member, as Embree's
/// manual has it for extended contexts.
struct GlassContext {
  RTCIntersectContext embree;
  glm::vec3 tint{1.0f};
};

/// One hierarchy over some of the instances.
struct EmbreeGroup {
  struct Member {
    std::uint32_t instance = 0;
    const EmbreePart* part = nullptr;  ///< null: the instance has a hierarchy of its own
  };
  EmbreeHandle<RTCScene> scene;
  EmbreeHandle<RTCScene> quick;  ///< the same geometries, for quick rays; null: `scene` serves them
  std::vector<Member> members;   ///< by Embree's geometry id

  [[nodiscard]] bool empty() const { return members.empty(); }
  [[nodiscard]] RTCScene for_ray(const Ray& ray) const {
    return ray.quick && quick ? quick.get() : scene.get();
  }
  void attach(RTCGeometry geometry, const Member& member);
  void commit() const;
};

struct EmbreeScene::Impl {
  /// What follows from an instance's transform.
  struct Placement {
    glm::mat3 normal_matrix{1.0f};
    float area_scale = 1.0f;
  };

  Impl(const Scene& s, std::size_t moving_count);
  void set_transform(std::size_t instance, const glm::mat4& transform);
  /// Embree's hit in our terms.
  [[nodiscard]] QuadHit resolve(const RTCRayHit& ray, const EmbreeGroup& group) const;

  const Scene* scene;
  std::size_t first_moving;
  EmbreeHandle<RTCDevice> device;
  std::vector<std::vector<EmbreePart>> parts;                // per mesh
  std::vector<EmbreeHandle<RTCScene>> mesh_scenes;           // per mesh, where it is instanced
  std::vector<EmbreeHandle<RTCGeometry>> instance_geometry;  // null where merged into its group
  std::vector<glm::mat4> transforms;                         // per instance, as the next
  std::vector<Placement> placements;
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
