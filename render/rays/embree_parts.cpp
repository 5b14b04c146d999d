#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <stdexcept>

#include "render/rays/embree_impl.h"
#include "render/scene/opacity.h"
#include "render/scene/texture_pyramid.h"

namespace eigenlight {
namespace {

void reject_holes(const RTCFilterFunctionNArguments* args) {
  const auto& part = *static_cast<const EmbreePart*>(args->geometryUserPtr);
  const glm::vec2 at =
      Quads::interpolate(part.uv[RTCHitN_primID(args->hit, args->N, 0)],
                         RTCHitN_u(args->hit, args->N, 0), RTCHitN_v(args->hit, args->N, 0));
  if (bilinear_alpha(*part.texture, at) < part.material->alpha_cutoff) args->valid[0] = 0;
}

// Multiplies the tint by the color of the pane and rejects the hit, so that the ray goes on through
// all panes and meets each once.
void gather_tint(const RTCFilterFunctionNArguments* args) {
  const auto& part = *static_cast<const EmbreePart*>(args->geometryUserPtr);
  reinterpret_cast<GlassContext*>(args->context)->tint *= part.material->base_color;
  args->valid[0] = 0;
}

}  // namespace

std::vector<EmbreePart> split_by_opacity(const Scene& scene, const Mesh& mesh) {
  const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
  std::vector<EmbreePart> parts;
  std::vector<std::uint32_t> solid, mixed;
  const bool holes = material.texture >= 0 && !mesh.texcoords.empty() &&
                     material.alpha_cutoff > 0.0f && !material.thin_glass;
  const Texture* texture =
      holes ? &scene.textures[static_cast<std::size_t>(material.texture)] : nullptr;
  const auto& uv = mesh.texcoords;
  std::optional<OpacityMap> map;
  if (holes) map.emplace(*texture, material.alpha_cutoff);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const Opacity opacity = map ? map->classify({uv[t.x], uv[t.y], uv[t.z]}) : Opacity::kSolid;
    if (opacity != Opacity::kHole) (opacity == Opacity::kSolid ? solid : mixed).push_back(i);
  }
  if (!solid.empty()) parts.push_back({&mesh, &material, nullptr, Quads(mesh, solid), {}});
  if (mixed.empty()) return parts;
  EmbreePart& part =
      parts.emplace_back(EmbreePart{&mesh, &material, texture, Quads(mesh, mixed), {}});
  for (const glm::uvec4& q : part.quads.corners()) {
    part.uv.push_back({uv[q.x], uv[q.y], uv[q.z], uv[q.w]});
  }
  return parts;
}

EmbreeHandle<RTCGeometry> make_quads(RTCDevice device, const Scene& scene, EmbreePart& part,
                                     const glm::mat4& transform) {
  EmbreeHandle<RTCGeometry> geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD));
  const auto& positions = part.mesh->positions;
  const auto corners = part.quads.corners();
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(glm::vec3), positions.size()));
  auto* indices = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0,
                                          RTC_FORMAT_UINT4, sizeof(glm::uvec4), corners.size());
  check_embree(device, scene);
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

void check_embree(RTCDevice device, const Scene& scene) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw std::runtime_error(fmt::format("Embree: error {} while building scene '{}'{}",
                                       static_cast<int>(error), scene.name,
                                       error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory)" : ""));
}

}  // namespace eigenlight
