#include "render/lights/emitter_table.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {

EmitterTable::EmitterTable(const Scene& scene, const EmbreeScene& geometry) {
  const auto count = scene.instances.size();
  emission_of_.resize(count, glm::vec3(0.0f));
  pdf_of_.resize(count, 0.0f);
  for (std::size_t i = 0; i < count; ++i) {
    add(scene, static_cast<std::uint32_t>(i), geometry.transforms()[i]);
  }
  std::vector<float> weights;
  weights.reserve(triangles_.size());
  for (const Triangle& t : triangles_) {
    weights.push_back(0.5f * glm::length(glm::cross(t.edge_u, t.edge_v)) *
                      luminance(emission_of_[t.instance]));
  }
  distribution_ = Distribution(weights);
  if (!(distribution_.total() > 0.0)) {
    triangles_.clear();
    return;
  }
  for (std::size_t i = 0; i < count; ++i) pdf_of_[i] = luminance(emission_of_[i]) / power();
  bound();
}

void EmitterTable::add(const Scene& scene, std::uint32_t instance, const glm::mat4& to_world) {
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[instance].mesh)];
  const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
  if (!(luminance(material.emission) > 0.0f) || material.thin_glass ||
      material.alpha_cutoff > 0.0f) {
    return;
  }
  emission_of_[instance] = material.emission;
  const auto world = [&](std::uint32_t vertex) {
    return glm::vec3(to_world * glm::vec4(mesh.positions[vertex], 1.0f));
  };
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 corner = world(t.x);
    triangles_.push_back({corner, world(t.y) - corner, world(t.z) - corner, instance});
  }
}

void EmitterTable::bound() {
  glm::vec3 low(triangles_.front().corner), high(low);
  for (const Triangle& t : triangles_) {
    for (const glm::vec3& p : {t.corner, t.corner + t.edge_u, t.corner + t.edge_v}) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  center_ = 0.5f * (low + high);
  radius_ = 0.5f * glm::length(high - low);
}

EmitterTable::Sample EmitterTable::sample(float pick, const glm::vec2& u) const {
  const Triangle& t = triangles_[distribution_.sample(pick).index];
  const float root = std::sqrt(u.x);  // uniform in the triangle (Turk, Graphics Gems I)
  const glm::vec3 position = t.corner + root * (1.0f - u.y) * t.edge_u + root * u.y * t.edge_v;
  return {position, glm::normalize(glm::cross(t.edge_u, t.edge_v)), emission_of_[t.instance],
          pdf_of_[t.instance]};
}

}  // namespace eigenlight
