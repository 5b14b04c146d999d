#include "render/rays/embree_scene.h"

#include "frame/check.h"
#include "frame/float_traps.h"
#include "render/rays/embree_impl.h"

namespace eigenlight {
namespace {

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

QuadHit EmbreeScene::Impl::resolve(const RTCRayHit& ray, const EmbreeGroup& group) const {
  const RTCHit& hit = ray.hit;
  glm::vec3 normal(hit.Ng_x, hit.Ng_y, hit.Ng_z);
  const bool instanced = hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  const EmbreeGroup::Member& member = group.members[instanced ? hit.instID[0] : hit.geomID];
  const EmbreePart* part = member.part;
  if (instanced) {
    const auto mesh = static_cast<std::size_t>(scene->instances[member.instance].mesh);
    part = &parts[mesh][hit.geomID];
    normal = placements[member.instance].normal_matrix * normal;
  }
  part->quads.prefetch(hit.primID);
  const float t = ray.ray.tfar;
  return {{t, hit.u, hit.v, member.instance, hit.primID, glm::normalize(normal)}, &part->quads};
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
  impl_->moving.commit();
  impl_->glass.commit();
  check_embree(impl_->device.get(), *impl_->scene);
}

std::optional<Hit> EmbreeScene::intersect(const Ray& ray) const {
  std::optional<QuadHit> hit = intersect_quad(ray);
  if (!hit) return std::nullopt;
  resolve_triangle(*hit);
  return *hit;
}

void EmbreeScene::resolve_triangle(QuadHit& hit) {
  const Quads::Point p = hit.quads->point(hit.triangle, hit.u, hit.v);
  hit.triangle = p.triangle;
  hit.u = p.u;
  hit.v = p.v;
}

std::optional<QuadHit> EmbreeScene::intersect_quad(const Ray& ray) const {
  const FloatTrapsOff embree_calculates_with_inf;
  RTCRayHit r{};
  r.ray = to_embree(ray);
  std::optional<QuadHit> closest;
  for (const EmbreeGroup* group : {&impl_->still, &impl_->moving}) {
    if (group->empty()) continue;
    r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context = incoherent_context();
    rtcIntersect1(group->for_ray(ray), &context, &r);
    // Embree shortens the ray at a hit, so a hit in the next group is closer.
    if (r.hit.primID != RTC_INVALID_GEOMETRY_ID) closest = impl_->resolve(r, *group);
  }
  return closest;
}

bool EmbreeScene::occluded(const Ray& ray) const {
  const FloatTrapsOff embree_calculates_with_inf;
  RTCRay r = to_embree(ray);
  for (const EmbreeGroup* group : {&impl_->still, &impl_->moving}) {
    if (group->empty()) continue;
    RTCIntersectContext context = incoherent_context();
    rtcOccluded1(group->for_ray(ray), &context, &r);
    if (r.tfar < 0.0f) return true;  // Embree sets tfar to -inf for an occluded ray
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
