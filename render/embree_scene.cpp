#include "render/embree_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "frame/check.h"
#include "frame/float_traps.h"
#include "render/opacity.h"
#include "render/quads.h"
#include "render/scene_check.h"
#include "render/texture_pyramid.h"

namespace eigenlight {
namespace {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;
using Geometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

// Triangles of one mesh as one Embree geometry, and what the filters need of them.
struct Part {
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  const Texture* texture = nullptr;  // of the holes; null: none
  Quads quads;
};

// What follows from an instance's transform.
struct Placement {
  glm::mat3 normal_matrix{1.0f};
  float area_scale = 1.0f;
};

Placement placement_of(const glm::mat4& to_world) {
  const glm::mat3 linear(to_world);
  return {glm::transpose(glm::inverse(linear)),
          std::pow(std::abs(glm::determinant(linear)), 2.0f / 3.0f)};
}

struct GlassContext {
  RTCIntersectContext embree;
  glm::vec3 tint{1.0f};
};

void reject_holes(const RTCFilterFunctionNArguments* args) {
  const auto& part = *static_cast<const Part*>(args->geometryUserPtr);
  const Quads::Point p =
      part.quads.point(RTCHitN_primID(args->hit, args->N, 0), RTCHitN_u(args->hit, args->N, 0),
                       RTCHitN_v(args->hit, args->N, 0));
  const glm::uvec3 t = part.mesh->triangles[p.triangle];
  const auto& uv = part.mesh->texcoords;
  const glm::vec2 at = (1.0f - p.u - p.v) * uv[t.x] + p.u * uv[t.y] + p.v * uv[t.z];
  if (bilinear_alpha(*part.texture, at) < part.material->alpha_cutoff) args->valid[0] = 0;
}

// Rejects every hit after taking its color, so that the ray meets all panes, each once.
void gather_tint(const RTCFilterFunctionNArguments* args) {
  const auto& part = *static_cast<const Part*>(args->geometryUserPtr);
  // `embree` is the first member, as Embree's manual has it for extended contexts.
  reinterpret_cast<GlassContext*>(args->context)->tint *= part.material->base_color;
  args->valid[0] = 0;
}

RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = ray.t_min;
  r.tfar = ray.t_max;
  r.mask = ~0U;
  return r;
}

RTCIntersectContext incoherent_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

}  // namespace

struct EmbreeScene::Impl {
  // One hierarchy over some of the instances.
  struct Group {
    struct Member {
      std::uint32_t instance = 0;
      const Part* part = nullptr;  // null: the instance has a hierarchy of its own
    };
    SceneHandle scene;
    SceneHandle quick;            // the same geometries, for quick rays; null: `scene` serves them
    std::vector<Member> members;  // by Embree's geometry id
    [[nodiscard]] bool empty() const { return members.empty(); }
    [[nodiscard]] RTCScene for_ray(const Ray& ray) const {
      return ray.quick && quick ? quick.get() : scene.get();
    }
  };

  Impl(const Scene& s, std::size_t moving_count);
  void split(const Mesh& mesh);
  [[nodiscard]] Geometry make_quads(Part& part, const glm::mat4& transform);
  [[nodiscard]] Geometry make_instance(int mesh, const glm::mat4& transform);
  [[nodiscard]] SceneHandle make_scene(RTCSceneFlags flags, RTCBuildQuality quality) const;
  [[nodiscard]] bool is_glass(int mesh) const {
    return scene->materials[index(scene->meshes[index(mesh)].material)].thin_glass;
  }
  void place(std::size_t instance, std::size_t uses);
  static void attach(Group& group, const Geometry& geometry, const Group::Member& member);
  void set_transform(std::size_t instance, const glm::mat4& transform);
  void check_device() const;
  [[nodiscard]] Hit resolve(const RTCRayHit& ray, const Group& group) const;

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  const Scene* scene;
  std::size_t first_moving;
  Device device;
  std::vector<std::vector<Part>> parts;     // per mesh
  std::vector<SceneHandle> mesh_scenes;     // per mesh, where it is instanced
  std::vector<Geometry> instance_geometry;  // per instance; null where merged into its group
  std::vector<glm::mat4> transforms;
  std::vector<Placement> placements;
  Group still, moving, glass;
};

EmbreeScene::Impl::Impl(const Scene& s, std::size_t moving_count) : scene(&s) {
  const FloatTrapsOff embree_calculates_with_inf;
  check_scene(s);
  EL_CHECK(moving_count <= s.instances.size(), "{} moving instances: the scene has {}",
           moving_count, s.instances.size());
  first_moving = s.instances.size() - moving_count;
  // No thread count: Embree would impose it on every TBB loop of the process.
  device.reset(rtcNewDevice(nullptr));
  if (!device) throw std::runtime_error("Embree: could not make a device");
  for (const Mesh& mesh : s.meshes) split(mesh);
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
  for (const Group* group : {&still, &moving, &glass}) {
    rtcCommitScene(group->scene.get());
    if (group->quick) rtcCommitScene(group->quick.get());
  }
  check_device();
}

// High quality splits triangles, but not those of robust scenes in Embree 3.13. A ray that gathers
// glass would meet a split pane twice.
SceneHandle EmbreeScene::Impl::make_scene(RTCSceneFlags flags, RTCBuildQuality quality) const {
  SceneHandle handle(rtcNewScene(device.get()));
  rtcSetSceneFlags(handle.get(), flags);
  rtcSetSceneBuildQuality(handle.get(), quality);
  return handle;
}

// Triangles that are nothing but hole are left out; those without holes need no filter.
void EmbreeScene::Impl::split(const Mesh& mesh) {
  const Material& material = scene->materials[index(mesh.material)];
  std::vector<Part>& of_mesh = parts.emplace_back();
  std::vector<std::uint32_t> solid, mixed;
  const bool holes = material.texture >= 0 && !mesh.texcoords.empty() &&
                     material.alpha_cutoff > 0.0f && !material.thin_glass;
  const Texture* texture = holes ? &scene->textures[index(material.texture)] : nullptr;
  std::optional<OpacityMap> map;
  if (holes) map.emplace(*texture, material.alpha_cutoff);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const auto& uv = mesh.texcoords;
    const Opacity opacity = map ? map->between({uv[t.x], uv[t.y], uv[t.z]}) : Opacity::kSolid;
    if (opacity != Opacity::kHole) (opacity == Opacity::kSolid ? solid : mixed).push_back(i);
  }
  if (!solid.empty()) of_mesh.push_back({&mesh, &material, nullptr, Quads(mesh, solid)});
  if (!mixed.empty()) of_mesh.push_back({&mesh, &material, texture, Quads(mesh, mixed)});
}

Geometry EmbreeScene::Impl::make_quads(Part& part, const glm::mat4& transform) {
  Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_QUAD));
  const auto& positions = part.mesh->positions;
  const auto corners = part.quads.corners();
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(glm::vec3), positions.size()));
  auto* indices = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0,
                                          RTC_FORMAT_UINT4, sizeof(glm::uvec4), corners.size());
  check_device();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const glm::vec3 p(transform * glm::vec4(positions[i], 1.0f));
    std::memcpy(vertices + 3 * i, &p, sizeof(p));
  }
  std::memcpy(indices, corners.data(), corners.size_bytes());
  rtcSetGeometryUserData(geometry.get(), &part);
  if (part.material->thin_glass) {
    rtcSetGeometryOccludedFilterFunction(geometry.get(), gather_tint);
  } else if (part.texture != nullptr) {
    rtcSetGeometryIntersectFilterFunction(geometry.get(), reject_holes);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), reject_holes);
  }
  rtcCommitGeometry(geometry.get());
  return geometry;
}

Geometry EmbreeScene::Impl::make_instance(int mesh, const glm::mat4& transform) {
  SceneHandle& shared = mesh_scenes[index(mesh)];
  if (!shared) {
    shared = make_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
    for (Part& part : parts[index(mesh)]) {
      rtcAttachGeometry(shared.get(), make_quads(part, glm::mat4(1.0f)).get());
    }
    rtcCommitScene(shared.get());
  }
  Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), shared.get());
  rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                          glm::value_ptr(transform));
  rtcCommitGeometry(geometry.get());
  return geometry;
}

void EmbreeScene::Impl::attach(Group& group, const Geometry& geometry,
                               const Group::Member& member) {
  const unsigned id = rtcAttachGeometry(group.scene.get(), geometry.get());
  if (group.quick) rtcAttachGeometryByID(group.quick.get(), geometry.get(), id);
  if (group.members.size() <= id) group.members.resize(id + 1);
  group.members[id] = member;
}

// Still meshes that stand once go into the hierarchy of their group as they are, in world space.
void EmbreeScene::Impl::place(std::size_t instance, std::size_t uses) {
  const Instance& placed = scene->instances[instance];
  transforms.push_back(placed.to_world);
  placements.push_back(placement_of(placed.to_world));
  instance_geometry.emplace_back();
  std::vector<Part>& of_mesh = parts[index(placed.mesh)];
  if (of_mesh.empty()) return;
  const bool moves = instance >= first_moving;
  const auto id = static_cast<std::uint32_t>(instance);
  Group& group = is_glass(placed.mesh) ? glass : moves ? moving : still;
  if (!moves && uses == 1) {
    for (Part& part : of_mesh) attach(group, make_quads(part, placed.to_world), {id, &part});
    return;
  }
  Geometry geometry = make_instance(placed.mesh, placed.to_world);
  attach(group, geometry, {id, nullptr});
  instance_geometry.back() = std::move(geometry);
}

void EmbreeScene::Impl::set_transform(std::size_t instance, const glm::mat4& transform) {
  transforms[instance] = transform;
  placements[instance] = placement_of(transform);
  const Geometry& geometry = instance_geometry[instance];
  if (!geometry) return;  // a mesh without triangles
  rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                          glm::value_ptr(transform));
  rtcCommitGeometry(geometry.get());
}

void EmbreeScene::Impl::check_device() const {
  const RTCError error = rtcGetDeviceError(device.get());
  if (error == RTC_ERROR_NONE) return;
  throw std::runtime_error(fmt::format("Embree: error {} while building scene '{}'{}",
                                       static_cast<int>(error), scene->name,
                                       error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory)" : ""));
}

// Embree's hit in our terms.
Hit EmbreeScene::Impl::resolve(const RTCRayHit& ray, const Group& group) const {
  const RTCHit& hit = ray.hit;
  glm::vec3 normal(hit.Ng_x, hit.Ng_y, hit.Ng_z);
  const bool instanced = hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  const Group::Member& member = group.members[instanced ? hit.instID[0] : hit.geomID];
  const Part* part = member.part;
  if (instanced) {
    part = &parts[index(scene->instances[member.instance].mesh)][hit.geomID];
    normal = placements[member.instance].normal_matrix * normal;
  }
  const Quads::Point p = part->quads.point(hit.primID, hit.u, hit.v);
  return {ray.ray.tfar, p.u, p.v, member.instance, p.triangle, glm::normalize(normal)};
}

EmbreeScene::EmbreeScene(const Scene& scene, std::size_t moving)
    : impl_(std::make_unique<Impl>(scene, moving)) {}
EmbreeScene::~EmbreeScene() = default;
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;

void EmbreeScene::set_poses(std::span<const glm::mat4> poses) {
  const std::size_t first = impl_->first_moving;
  EL_CHECK(poses.size() == impl_->transforms.size() - first, "{} poses: expected {}", poses.size(),
           impl_->transforms.size() - first);
  const FloatTrapsOff embree_calculates_with_inf;
  bool changed = false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (impl_->transforms[first + i] == poses[i]) continue;
    impl_->set_transform(first + i, poses[i]);
    changed = true;
  }
  if (!changed) return;
  rtcCommitScene(impl_->moving.scene.get());
  rtcCommitScene(impl_->glass.scene.get());
  impl_->check_device();
}

std::optional<Hit> EmbreeScene::intersect(const Ray& ray) const {
  const FloatTrapsOff embree_calculates_with_inf;
  RTCRayHit r{};
  r.ray = to_embree(ray);
  std::optional<Hit> closest;
  for (const Impl::Group* group : {&impl_->still, &impl_->moving}) {
    if (group->empty()) continue;
    r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context = incoherent_context();
    rtcIntersect1(group->for_ray(ray), &context, &r);
    // The ray ends where it met something, so that a further group's hits are closer.
    if (r.hit.primID != RTC_INVALID_GEOMETRY_ID) closest = impl_->resolve(r, *group);
  }
  return closest;
}

bool EmbreeScene::occluded(const Ray& ray) const {
  const FloatTrapsOff embree_calculates_with_inf;
  RTCRay r = to_embree(ray);
  for (const Impl::Group* group : {&impl_->still, &impl_->moving}) {
    if (group->empty()) continue;
    RTCIntersectContext context = incoherent_context();
    rtcOccluded1(group->for_ray(ray), &context, &r);
    if (r.tfar < 0.0f) return true;  // Embree's mark of an occluded ray
  }
  return false;
}

glm::vec3 EmbreeScene::glass_tint(const Ray& ray) const {
  if (impl_->glass.empty()) return glm::vec3(1.0f);
  const FloatTrapsOff embree_calculates_with_inf;
  GlassContext context{incoherent_context()};
  RTCRay r = to_embree(ray);
  rtcOccluded1(impl_->glass.scene.get(), &context.embree, &r);
  return context.tint;
}

bool EmbreeScene::has_glass() const { return !impl_->glass.empty(); }

std::span<const glm::mat4> EmbreeScene::transforms() const { return impl_->transforms; }

const glm::mat3& EmbreeScene::normal_matrix(std::uint32_t instance) const {
  return impl_->placements[instance].normal_matrix;
}

float EmbreeScene::area_scale(std::uint32_t instance) const {
  return impl_->placements[instance].area_scale;
}

}  // namespace eigenlight
