#include <array>
#include <cmath>

#include "render/builtin/builtin_atrium_parts.h"
#include "render/builtin/builtin_parts.h"

namespace eigenlight {
namespace {

using atrium::Stones;

/// x of the columns along the court. Piers stand at the corners instead.
float column_x(int i) { return -atrium::kCourtX + atrium::kBay * static_cast<float>(i); }

/// Places `mesh` in all bays around the court, facing the court.
void place_in_bays(Scene& scene, int mesh, float y) {
  for (int i = 0; i < atrium::kLongBays; ++i) {
    const float x = column_x(i) + 0.5f * atrium::kBay;
    place(scene, mesh, {x, y, -atrium::kCourtZ}, 0.0f);
    place(scene, mesh, {x, y, atrium::kCourtZ}, 180.0f);
  }
  for (const float z : {-0.5f * atrium::kBay, 0.5f * atrium::kBay}) {
    place(scene, mesh, {-atrium::kCourtX, y, z}, 90.0f);
    place(scene, mesh, {atrium::kCourtX, y, z}, -90.0f);
  }
}

void place_columns(Scene& scene, int column, int pier, float y) {
  for (int i = 0; i <= atrium::kLongBays; ++i) {
    const bool corner = i == 0 || i == atrium::kLongBays;
    for (const float z : {-atrium::kCourtZ, atrium::kCourtZ}) {
      place(scene, corner ? pier : column, {column_x(i), y, z});
    }
  }
  for (const float x : {-atrium::kCourtX, atrium::kCourtX}) place(scene, column, {x, y, 0.0f});
}

void add_arcades(Scene& scene, const Stones& stones) {
  for (const atrium::Storey& storey : {atrium::kGround, atrium::kUpper}) {
    const int column = add_mesh(scene, atrium::column(storey, stones.marble));
    const int pier = add_mesh(scene, atrium::pier(storey, stones.blocks));
    const int arch = add_mesh(scene, atrium::arch(storey, stones.blocks));
    place_columns(scene, column, pier, storey.floor);
    place_in_bays(scene, arch, storey.floor);
  }
  const int baluster = add_mesh(scene, atrium::baluster(stones.marble));
  const int rail = add_mesh(scene, atrium::rail(stones.marble));
  place_in_bays(scene, rail, atrium::kUpper.floor);
  const auto place_row = [&](const glm::vec3& middle, const glm::vec3& along) {
    for (int k = -3; k <= 3; ++k) {
      place(scene, baluster, middle + along * (0.31f * static_cast<float>(k)));
    }
  };
  for (const float side : {-1.0f, 1.0f}) {
    for (int i = 0; i < atrium::kLongBays; ++i) {
      place_row({column_x(i) + 0.5f * atrium::kBay, atrium::kUpper.floor, side * atrium::kCourtZ},
                {1, 0, 0});
      // The two bays of each short side.
      if (i < 2) {
        const float z = (static_cast<float>(i) - 0.5f) * atrium::kBay;
        place_row({side * atrium::kCourtX, atrium::kUpper.floor, z}, {0, 0, 1});
      }
    }
  }
}

/// Adds cloth of three colors in the court and behind the arches.
void add_banners(Scene& scene) {
  const std::array<Cloth, 3> cloths{{{{0.55f, 0.04f, 0.035f}, {0.75f, 0.52f, 0.14f}},
                                     {{0.05f, 0.32f, 0.10f}, {0.70f, 0.62f, 0.25f}},
                                     {{0.04f, 0.12f, 0.48f}, {0.72f, 0.66f, 0.5f}}}};
  const std::array<const char*, 3> names{"red cloth", "green cloth", "blue cloth"};
  std::array<int, 3> banners{}, curtains{};
  for (std::size_t c = 0; c < cloths.size(); ++c) {
    const int material = add_material(scene, paint_cloth(names[c], cloths[c]));
    banners[c] = add_mesh(scene, atrium::banner(material));
    curtains[c] = add_mesh(scene, atrium::curtain(material));
  }
  // Banners hang in front of every second column, and curtains in some arches. The camera leaves
  // the court through an open arch.
  constexpr float kBannerZ = atrium::kCourtZ - 0.52f, kCurtainZ = atrium::kCourtZ + 0.42f;
  for (std::size_t i = 0; i < 4; ++i) {
    const float x = column_x(1 + 2 * static_cast<int>(i));
    place(scene, banners[i % 3], {x, 0, -kBannerZ}, 0.0f);
    place(scene, banners[(i + 1) % 3], {x, 0, kBannerZ}, 180.0f);
  }
  constexpr std::array<int, 4> kBack{0, 2, 3, 5}, kFront{1, 2, 4, 7};
  for (std::size_t i = 0; i < kBack.size(); ++i) {
    const auto middle = [](int bay) { return column_x(bay) + 0.5f * atrium::kBay; };
    place(scene, curtains[(i + 2) % 3], {middle(kBack[i]), 0, -kCurtainZ}, 0.0f);
    place(scene, curtains[i % 3], {middle(kFront[i]), 0, kCurtainZ}, 180.0f);
  }
}

void add_clutter(Scene& scene, const Stones& stones) {
  atrium::add_fountain(scene, stones);
  const int clay = add_material(scene, paint_clouds("clay", {.dark = {0.38f, 0.15f, 0.07f},
                                                             .light = {0.55f, 0.25f, 0.12f},
                                                             .cells = 6,
                                                             .seed = 9}));
  const int green = add_material(scene, "leaves", {0.10f, 0.26f, 0.05f});
  const int vase = add_mesh(scene, atrium::vase(clay));
  const int bush = add_mesh(scene, atrium::bush(green));
  constexpr std::array<glm::vec2, 8> kPots{{{-8.25f, -1.8f},
                                            {-8.25f, 1.8f},
                                            {-2.75f, -1.8f},
                                            {2.75f, -1.8f},
                                            {8.25f, -1.8f},
                                            {10.1f, 1.8f},
                                            {-5.4f, 5.4f},
                                            {1.2f, 5.4f}}};
  float turn = 0.0f;
  for (const glm::vec2& pot : kPots) {
    place(scene, vase, {pot.x, 0, pot.y});
    place(scene, bush, {pot.x, atrium::kVaseHeight, pot.y}, turn += 77.0f);
  }
  const int urn = add_mesh(scene, atrium::pedestal(stones.marble));
  for (const float x : {-13.6f, 13.6f}) place(scene, urn, {x, 0, 0}, x < 0 ? 90.0f : -90.0f);
}

}  // namespace

Scene make_atrium() {
  Scene scene;
  scene.name = "atrium";
  scene.title = "Sunlit court";
  const Stones stones = atrium::add_stones(scene);
  atrium::add_shell(scene, stones);
  add_arcades(scene, stones);
  add_banners(scene);
  add_clutter(scene, stones);

  scene.lights.suns.push_back({glm::normalize(glm::vec3(0.26f, 1.0f, -0.17f)), {50, 45, 36}});
  scene.lights.sky = {3.0f, 4.0f, 5.5f};
  scene.exposure = 0.45f;
  scene.fov_y = 50.0f;
  // The path leads along the court, around the fountain, through an open arch, and back along the
  // gallery.
  scene.camera_path = {{0.0f, {-9.4f, 1.7f, -0.4f}, {0.0f, 2.9f, 0.3f}},
                       {2.0f, {-5.6f, 1.8f, 0.3f}, {2.0f, 2.6f, -1.6f}},
                       {4.0f, {-1.6f, 2.0f, 1.45f}, {4.5f, 2.5f, -1.0f}},
                       {6.0f, {2.6f, 2.0f, 1.1f}, {7.5f, 2.0f, 2.4f}},
                       {8.0f, {6.5f, 1.8f, 1.5f}, {6.9f, 1.9f, 6.0f}},
                       {9.5f, {6.75f, 1.8f, 3.6f}, {2.5f, 1.9f, 5.2f}},
                       {11.5f, {4.2f, 1.8f, 4.6f}, {-4.0f, 2.0f, 4.0f}},
                       {13.5f, {0.4f, 1.8f, 4.5f}, {-8.0f, 2.2f, 3.2f}}};
  return scene;
}

}  // namespace eigenlight
