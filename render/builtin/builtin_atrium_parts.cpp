#include "render/builtin/builtin_atrium_parts.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "frame/random.h"
#include "render/builtin/builtin_parts.h"

namespace eigenlight::atrium {
namespace {

constexpr float kAbacus = 0.12f;  ///< height of the plate between a column and its arches

}  // namespace

Mesh column(const Storey& storey, int material) {
  const float h = storey.spring - kAbacus;
  MeshBuilder builder;
  builder.box({-0.36f, 0.0f, -0.36f}, {0.36f, 0.1f, 0.36f});
  builder.lathe({.profile = {{0.34f, 0.10f},
                             {0.36f, 0.14f},
                             {0.36f, 0.18f},
                             {0.34f, 0.22f},
                             {0.29f, 0.24f},
                             {0.29f, 0.28f},
                             {0.265f, 0.34f},
                             {0.265f, 0.40f * h},
                             {0.255f, 0.70f * h},
                             {0.235f, h - 0.42f},
                             {0.27f, h - 0.40f},
                             {0.27f, h - 0.36f},
                             {0.24f, h - 0.34f},
                             {0.25f, h - 0.22f},
                             {0.29f, h - 0.12f},
                             {0.36f, h - 0.05f},
                             {0.38f, h}},
                 .segments = 40,
                 .foot = glm::vec3(0.0f)});
  builder.box({-0.39f, h, -0.39f}, {0.39f, storey.spring, 0.39f});
  return builder.take("column", material, 0.5f);
}

Mesh pier(const Storey& storey, int material) {
  MeshBuilder builder;
  builder.box({-0.36f, 0.0f, -0.36f}, {0.36f, 0.18f, 0.36f});
  builder.box({-0.29f, 0.18f, -0.29f}, {0.29f, storey.top, 0.29f});
  builder.box({-0.38f, storey.spring - kAbacus, -0.38f}, {0.38f, storey.spring, 0.38f});
  return builder.take("pier", material, 0.4f);
}

Mesh arch(const Storey& storey, int material) {
  MeshBuilder builder;
  builder.arch({.half_width = 0.5f * kBay,
                .radius = 1.0f,
                .spring = storey.spring,
                .top = storey.top,
                .depth = 0.5f,
                .segments = 28});
  return builder.take("arch", material, 0.4f);
}

Mesh baluster(int material) {
  MeshBuilder builder;
  builder.lathe({.profile = {{0.07f, 0.10f},
                             {0.07f, 0.15f},
                             {0.04f, 0.19f},
                             {0.075f, 0.32f},
                             {0.07f, 0.40f},
                             {0.038f, 0.58f},
                             {0.04f, 0.66f},
                             {0.065f, 0.72f},
                             {0.065f, 0.80f}},
                 .segments = 14,
                 .foot = glm::vec3(0.0f)});
  return builder.take("baluster", material, 0.5f);
}

Mesh rail(int material) {
  MeshBuilder builder;
  const float half = 0.5f * kBay - 0.2f;
  builder.box({-half, 0.0f, -0.1f}, {half, 0.1f, 0.1f});
  builder.box({-half, 0.8f, -0.12f}, {half, 0.9f, 0.12f});
  return builder.take("rail", material, 0.5f);
}

Mesh banner(int material) {
  MeshBuilder builder;
  constexpr float kTop = 6.05f, kLength = 3.0f, kWidth = 1.0f;
  builder.sheet(20, 40, [](float u, float v) {
    // Folds grow towards the free lower end.
    const float fold = 0.02f + 0.05f * v;
    const float z = fold * std::sin(9.0f * u + 2.5f * v) + 0.04f * v * std::sin(4.0f * v + 1.0f);
    return glm::vec3((u - 0.5f) * kWidth, kTop - kLength * v, z);
  });
  builder.box({-0.56f, kTop, -0.03f}, {0.56f, kTop + 0.05f, 0.03f});
  return builder.take("banner", material);
}

Mesh curtain(int material) {
  MeshBuilder builder;
  constexpr float kTop = 4.15f, kLength = 3.3f, kWidth = 2.5f;
  builder.sheet(72, 32, [](float u, float v) {
    const float depth = 0.09f * (0.5f + 0.5f * v);
    const float z = depth * std::sin(52.0f * u + 0.8f * std::sin(3.0f * v));
    // The curtain is gathered in the middle as if tied by a cord.
    const float narrow = 1.0f - 0.16f * std::sin(glm::pi<float>() * v);
    return glm::vec3((u - 0.5f) * kWidth * narrow, kTop - kLength * v, z);
  });
  return builder.take("curtain", material);
}

Mesh vase(int material) {
  MeshBuilder builder;
  builder.lathe({.profile = {{0.0f, 0.0f},
                             {0.17f, 0.0f},
                             {0.18f, 0.04f},
                             {0.15f, 0.08f},
                             {0.25f, 0.22f},
                             {0.30f, 0.36f},
                             {0.28f, 0.48f},
                             {0.23f, 0.55f},
                             {0.29f, kVaseHeight},
                             {0.25f, kVaseHeight},
                             {0.20f, 0.56f},
                             {0.0f, 0.55f}},
                 .segments = 36,
                 .foot = glm::vec3(0.0f)});
  return builder.take("vase", material, 0.5f);
}

Mesh bush(int material) {
  MeshBuilder builder;
  constexpr std::uint32_t kLeaves = 420;
  for (std::uint32_t i = 0; i < kLeaves; ++i) {
    const auto random = [i](std::uint32_t k) { return to_unit(hash_key(11U, i, k)); };
    const float y = 2.0f * random(0) - 1.0f, turn = glm::two_pi<float>() * random(1);
    const float ring = std::sqrt(1.0f - y * y), away = 0.22f + 0.16f * random(2);
    const glm::vec3 out(ring * std::cos(turn), y, ring * std::sin(turn));
    const glm::vec3 aside =
        normalize(cross(out, glm::vec3(random(3) - 0.5f, random(4) - 0.5f, random(5) + 0.1f)));
    const glm::vec3 tip = normalize(0.6f * out + cross(aside, out));
    builder.leaf(glm::vec3(0, 0.26f, 0) + out * away, 0.022f * aside, 0.06f * tip);
  }
  return builder.take("bush", material);
}

Mesh pedestal(int material) {
  MeshBuilder builder;
  builder.box({-0.6f, 0.0f, -0.6f}, {0.6f, 0.15f, 0.6f});
  builder.box({-0.45f, 0.15f, -0.45f}, {0.45f, 1.2f, 0.45f});
  builder.box({-0.55f, 1.2f, -0.55f}, {0.55f, 1.32f, 0.55f});
  builder.lathe({.profile = {{0.20f, 0.0f},
                             {0.22f, 0.05f},
                             {0.09f, 0.14f},
                             {0.10f, 0.24f},
                             {0.30f, 0.42f},
                             {0.42f, 0.70f},
                             {0.44f, 0.95f},
                             {0.36f, 1.02f},
                             {0.30f, 1.10f},
                             {0.16f, 1.18f},
                             {0.06f, 1.24f},
                             {0.08f, 1.30f},
                             {0.0f, 1.38f}},
                 .segments = 40,
                 .foot = {0, 1.32f, 0}});
  return builder.take("urn", material, 0.5f);
}

void add_fountain(Scene& scene, const Stones& stones) {
  MeshBuilder builder;
  // Two octagonal steps, the basin, its foot and the upper bowl.
  builder.lathe({{{1.75f, 0.0f}, {1.75f, 0.13f}, {1.45f, 0.13f}, {1.45f, 0.26f}, {1.0f, 0.26f}},
                 8,
                 glm::vec3(0.0f)});
  builder.lathe({{{1.02f, 0.26f},
                  {1.06f, 0.34f},
                  {1.0f, 0.4f},
                  {1.02f, 0.62f},
                  {1.12f, 0.7f},
                  {1.12f, 0.76f},
                  {0.94f, 0.76f},
                  {0.92f, 0.5f}},
                 64,
                 glm::vec3(0.0f)});
  builder.lathe({{{0.24f, 0.3f},
                  {0.18f, 0.7f},
                  {0.12f, 0.8f},
                  {0.12f, 1.1f},
                  {0.2f, 1.2f},
                  {0.46f, 1.32f},
                  {0.6f, 1.45f},
                  {0.6f, 1.49f},
                  {0.54f, 1.49f},
                  {0.4f, 1.4f},
                  {0.08f, 1.36f},
                  {0.06f, 1.6f},
                  {0.1f, 1.68f},
                  {0.06f, 1.76f},
                  {0.0f, 1.78f}},
                 48,
                 glm::vec3(0.0f)});
  place_once(scene, builder.take("fountain", stones.marble, 0.5f));
  builder.lathe({{{0.95f, 0.66f}, {0.0f, 0.66f}}, 48, glm::vec3(0.0f)});
  builder.lathe({{{0.5f, 1.45f}, {0.0f, 1.45f}}, 48, glm::vec3(0.0f)});
  place_once(scene, builder.take("water", stones.water));
}

}  // namespace eigenlight::atrium
