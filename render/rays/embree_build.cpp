#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <stdexcept>

#include "frame/check.h"
#include "frame/float_traps.h"
#include "render/rays/embree_impl.h"
#include "render/scene/scene_check.h"

namespace eigenlight {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void pose(RTCGeometry instance, const glm::mat4& to_world) {
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, glm::value_ptr(to_world));
  rtcCommitGeometry(instance);
}

}  // namespace

void EmbreeGroup::attach(RTCGeometry geometry, const Member& member) {
  const unsigned id = rtcAttachGeometry(scene.get(), geometry);
  if (quick) rtcAttachGeometryByID(quick.get(), geometry, id);
  if (members.size() <= id) members.resize(id + 1);
  members[id] = member;
}

void EmbreeGroup::commit() const {
  rtcCommitScene(scene.get());
  if (quick) rtcCommitScene(quick.get());
}

EmbreeScene::Impl::Impl(const Scene& s, std::size_t moving_count) : scene(&s) {
  const FloatTrapsOff embree_calculates_with_inf;
  check_scene(s);
  EL_CHECK(moving_count <= s.instances.size(), "{} moving instances: expected at most {}",
           moving_count, s.instances.size());
  first_moving = s.instances.size() - moving_count;
  // Embree would apply a thread count to every TBB loop of the process, so none is given.
  device.reset(rtcNewDevice(nullptr));
  if (!device) throw std::runtime_error("Embree: cannot create a device");
  for (const Mesh& mesh : s.meshes) parts.push_back(split_by_opacity(s, mesh));
  mesh_scenes.resize(s.meshes.size());
  still.scene = make_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
  still.quick = make_scene(RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
  moving.scene = make_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_LOW);
  glass.scene = make_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
  std::vector<std::size_t> uses(s.meshes.size(), 0);
  for (const Instance& instance : s.instances) ++uses[index(instance.mesh)];
  for (std::size_t i = 0; i < s.instances.size(); ++i) {
    place(i, uses[index(s.instances[i].mesh)]);
  }
  for (const EmbreeGroup* group : {&still, &moving, &glass}) group->commit();
  check_embree(device.get(), s);
}

// High build quality splits triangles, except in robust scenes (Embree 3.13). The scene of thin
// glass must be robust, because a ray would collect the tint of a split pane twice.
EmbreeHandle<RTCScene> EmbreeScene::Impl::make_scene(RTCSceneFlags flags,
                                                     RTCBuildQuality quality) const {
  EmbreeHandle<RTCScene> handle(rtcNewScene(device.get()));
  rtcSetSceneFlags(handle.get(), flags);
  rtcSetSceneBuildQuality(handle.get(), quality);
  return handle;
}

bool EmbreeScene::Impl::is_glass(int mesh) const {
  return scene->materials[index(scene->meshes[index(mesh)].material)].thin_glass;
}

EmbreeScene::Impl::Placement EmbreeScene::Impl::placement_of(const glm::mat4& to_world) {
  const glm::mat3 linear(to_world);
  return {glm::transpose(glm::inverse(linear)),
          std::pow(std::abs(glm::determinant(linear)), 2.0f / 3.0f)};
}

EmbreeHandle<RTCGeometry> EmbreeScene::Impl::make_instance(int mesh, const glm::mat4& transform) {
  EmbreeHandle<RTCScene>& shared = mesh_scenes[index(mesh)];
  if (!shared) {
    shared = make_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
    for (EmbreePart& part : parts[index(mesh)]) {
      rtcAttachGeometry(shared.get(),
                        make_quads(device.get(), *scene, part, glm::mat4(1.0f)).get());
    }
    rtcCommitScene(shared.get());
  }
  EmbreeHandle<RTCGeometry> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), shared.get());
  pose(geometry.get(), transform);
  return geometry;
}

// Meshes that do not move and are used once are merged into the hierarchy of their group in world
// space. All others become Embree instances.
void EmbreeScene::Impl::place(std::size_t instance, std::size_t uses) {
  const Instance& placed = scene->instances[instance];
  transforms.push_back(placed.to_world);
  placements.push_back(placement_of(placed.to_world));
  instance_geometry.emplace_back();
  std::vector<EmbreePart>& of_mesh = parts[index(placed.mesh)];
  if (of_mesh.empty()) return;
  const bool moves = instance >= first_moving;
  const auto id = static_cast<std::uint32_t>(instance);
  EmbreeGroup& group = is_glass(placed.mesh) ? glass : moves ? moving : still;
  if (!moves && uses == 1) {
    for (EmbreePart& part : of_mesh) {
      group.attach(make_quads(device.get(), *scene, part, placed.to_world).get(), {id, &part});
    }
    return;
  }
  instance_geometry.back() = make_instance(placed.mesh, placed.to_world);
  group.attach(instance_geometry.back().get(), {id, nullptr});
}

void EmbreeScene::Impl::set_transform(std::size_t instance, const glm::mat4& transform) {
  transforms[instance] = transform;
  placements[instance] = placement_of(transform);
  const EmbreeHandle<RTCGeometry>& geometry = instance_geometry[instance];
  if (geometry) pose(geometry.get(), transform);  // null if the mesh has no triangles
}

}  // namespace eigenlight
