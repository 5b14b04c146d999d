#include "render/embree_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "frame/check.h"
#include "frame/float_traps.h"
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

// What the filters need of a mesh.
struct MeshLook {
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  const Texture* texture = nullptr;
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
  const auto& look = *static_cast<const MeshLook*>(args->geometryUserPtr);
  const glm::uvec3 t = look.mesh->triangles[RTCHitN_primID(args->hit, args->N, 0)];
  const float u = RTCHitN_u(args->hit, args->N, 0);
  const float v = RTCHitN_v(args->hit, args->N, 0);
  const auto& uv = look.mesh->texcoords;
  const glm::vec2 at = (1.0f - u - v) * uv[t.x] + u * uv[t.y] + v * uv[t.z];
  if (bilinear_alpha(*look.texture, at) < look.material->alpha_cutoff) args->valid[0] = 0;
}

// Rejects every hit after taking its color, so that the ray meets all panes, each once.
void gather_tint(const RTCFilterFunctionNArguments* args) {
  const auto& look = *static_cast<const MeshLook*>(args->geometryUserPtr);
  // `embree` is the first member, as Embree's manual has it for extended contexts.
  reinterpret_cast<GlassContext*>(args->context)->tint *= look.material->base_color;
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
    SceneHandle scene;
    std::map<unsigned, std::uint32_t> pending;  // attached geometry to instance, while building
    std::vector<std::uint32_t> instance_of;     // the same, dense
    [[nodiscard]] bool empty() const { return instance_of.empty(); }
  };

  Impl(const Scene& s, std::size_t moving_count);
  [[nodiscard]] Geometry make_triangles(int mesh, const glm::mat4& transform, bool glass);
  [[nodiscard]] Geometry make_instance(int mesh, const glm::mat4& transform, bool glass);
  [[nodiscard]] SceneHandle make_scene(RTCBuildQuality quality) const;
  [[nodiscard]] bool is_glass(int mesh) const { return looks[index(mesh)].material->thin_glass; }
  void attach(std::size_t instance, std::size_t uses);
  void commit(Group& group);
  void set_transform(std::size_t instance, const glm::mat4& transform);
  void check_device() const;
  void intersect(const Group& group, RTCRayHit& ray, std::uint32_t& instance) const;

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  const Scene* scene;
  std::size_t first_moving;
  Device device;
  std::vector<MeshLook> looks;              // per mesh
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
  for (const Mesh& mesh : s.meshes) {
    const Material& material = s.materials[index(mesh.material)];
    const bool textured = material.texture >= 0 && !mesh.texcoords.empty();
    looks.push_back({&mesh, &material, textured ? &s.textures[index(material.texture)] : nullptr});
  }
  mesh_scenes.resize(s.meshes.size());
  still.scene = make_scene(RTC_BUILD_QUALITY_MEDIUM);
  moving.scene = make_scene(RTC_BUILD_QUALITY_LOW);
  glass.scene = make_scene(RTC_BUILD_QUALITY_MEDIUM);
  std::vector<std::size_t> uses(s.meshes.size(), 0);
  for (const Instance& instance : s.instances) ++uses[index(instance.mesh)];
  for (std::size_t i = 0; i < s.instances.size(); ++i) {
    attach(i, uses[index(s.instances[i].mesh)]);
  }
  for (Group* group : {&still, &moving, &glass}) commit(*group);
}

// High quality would do nothing here: Embree 3.13 splits no triangles of robust scenes (and then a
// ray could meet one pane twice).
SceneHandle EmbreeScene::Impl::make_scene(RTCBuildQuality quality) const {
  SceneHandle handle(rtcNewScene(device.get()));
  rtcSetSceneFlags(handle.get(), RTC_SCENE_FLAG_ROBUST);  // no ray slips through a shared edge
  rtcSetSceneBuildQuality(handle.get(), quality);
  return handle;
}

Geometry EmbreeScene::Impl::make_triangles(int mesh, const glm::mat4& transform, bool glass_pane) {
  MeshLook& look = looks[index(mesh)];
  Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(glm::vec3), look.mesh->positions.size()));
  auto* triangles =
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(glm::uvec3), look.mesh->triangles.size());
  check_device();
  for (std::size_t i = 0; i < look.mesh->positions.size(); ++i) {
    const glm::vec3 p(transform * glm::vec4(look.mesh->positions[i], 1.0f));
    std::memcpy(vertices + 3 * i, &p, sizeof(p));
  }
  std::memcpy(triangles, look.mesh->triangles.data(),
              look.mesh->triangles.size() * sizeof(glm::uvec3));
  rtcSetGeometryUserData(geometry.get(), &look);
  if (glass_pane) {
    rtcSetGeometryOccludedFilterFunction(geometry.get(), gather_tint);
  } else if (look.texture != nullptr && look.material->alpha_cutoff > 0.0f) {
    rtcSetGeometryIntersectFilterFunction(geometry.get(), reject_holes);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), reject_holes);
  }
  return geometry;
}

Geometry EmbreeScene::Impl::make_instance(int mesh, const glm::mat4& transform, bool glass_pane) {
  SceneHandle& shared = mesh_scenes[index(mesh)];
  if (!shared) {
    shared = make_scene(RTC_BUILD_QUALITY_MEDIUM);
    const Geometry triangles = make_triangles(mesh, glm::mat4(1.0f), glass_pane);
    rtcCommitGeometry(triangles.get());
    rtcAttachGeometry(shared.get(), triangles.get());
    rtcCommitScene(shared.get());
  }
  Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), shared.get());
  rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                          glm::value_ptr(transform));
  return geometry;
}

// Still meshes that stand once go into the hierarchy of their group as they are, in world space.
void EmbreeScene::Impl::attach(std::size_t instance, std::size_t uses) {
  const Instance& placed = scene->instances[instance];
  transforms.push_back(placed.to_world);
  placements.push_back(placement_of(placed.to_world));
  instance_geometry.emplace_back();
  if (scene->meshes[index(placed.mesh)].triangles.empty()) return;
  const bool moves = instance >= first_moving;
  const bool pane = is_glass(placed.mesh);
  Group& group = pane ? glass : moves ? moving : still;
  const bool merged = !moves && uses == 1;
  Geometry geometry = merged ? make_triangles(placed.mesh, placed.to_world, pane)
                             : make_instance(placed.mesh, placed.to_world, pane);
  rtcCommitGeometry(geometry.get());
  const unsigned id = rtcAttachGeometry(group.scene.get(), geometry.get());
  group.pending[id] = static_cast<std::uint32_t>(instance);
  if (!merged) instance_geometry.back() = std::move(geometry);
}

void EmbreeScene::Impl::commit(Group& group) {
  rtcCommitScene(group.scene.get());
  check_device();
  if (group.pending.empty()) return;
  group.instance_of.resize(group.pending.rbegin()->first + 1);
  for (const auto& [id, instance] : group.pending) group.instance_of[id] = instance;
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

void EmbreeScene::Impl::intersect(const Group& group, RTCRayHit& ray,
                                  std::uint32_t& instance) const {
  const FloatTrapsOff embree_calculates_with_inf;
  RTCIntersectContext context = incoherent_context();
  const unsigned before = ray.hit.primID;
  ray.hit.primID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(group.scene.get(), &context, &ray);
  if (ray.hit.primID == RTC_INVALID_GEOMETRY_ID) {
    ray.hit.primID = before;
    return;
  }
  const bool instanced = ray.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  instance = group.instance_of[instanced ? ray.hit.instID[0] : ray.hit.geomID];
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
  RTCRayHit r{};
  r.ray = to_embree(ray);
  r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  std::uint32_t instance = 0;
  impl_->intersect(impl_->still, r, instance);
  if (!impl_->moving.empty()) impl_->intersect(impl_->moving, r, instance);
  if (r.hit.primID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  glm::vec3 normal(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z);
  if (impl_->instance_geometry[instance]) {
    normal = impl_->placements[instance].normal_matrix * normal;
  }
  return Hit{r.ray.tfar, r.hit.u, r.hit.v, instance, r.hit.primID, glm::normalize(normal)};
}

bool EmbreeScene::occluded(const Ray& ray) const {
  const FloatTrapsOff embree_calculates_with_inf;
  RTCRay r = to_embree(ray);
  for (const Impl::Group* group : {&impl_->still, &impl_->moving}) {
    if (group->empty()) continue;
    RTCIntersectContext context = incoherent_context();
    rtcOccluded1(group->scene.get(), &context, &r);
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
