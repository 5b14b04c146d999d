#include <array>
#include <string>

#include "render/builtin/builtin_parts.h"
#include "render/scene/mesh_builder.h"
#include "render/scene/procedural_texture.h"

namespace eigenlight {
namespace {

// Units are meters. The picture room lies around the origin, and the red room behind the wall at
// kWallX.
constexpr float kWallX = 8.0f, kWallZ = 4.0f, kHeight = 5.0f, kThick = 0.3f;
constexpr float kRedX0 = kWallX + kThick, kRedX1 = 15.5f, kRedHeight = 4.2f;
constexpr float kDoorZ0 = 0.6f, kDoorZ1 = 2.4f, kDoorHeight = 2.9f;
constexpr float kSkylightX0 = 1.6f, kSkylightX1 = 5.4f, kSkylightZ = 1.0f, kWellTop = 5.6f;

struct Materials {
  int cream, ceiling, red, parquet, carpet, wood, gold, stone;
};

Materials add_materials(Scene& scene) {
  Materials m{};
  m.cream = add_material(scene, paint_clouds("cream wall", {.dark = {0.56f, 0.52f, 0.44f},
                                                            .light = {0.66f, 0.62f, 0.54f},
                                                            .cells = 4,
                                                            .seed = 21}));
  m.ceiling = add_material(scene, "ceiling", {0.78f, 0.77f, 0.74f});
  m.red = add_material(scene, paint_clouds("red wall", {.dark = {0.48f, 0.05f, 0.045f},
                                                        .light = {0.60f, 0.09f, 0.07f},
                                                        .cells = 4,
                                                        .seed = 22}));
  m.parquet = add_material(scene, paint_boards("parquet", {.dark = {0.20f, 0.11f, 0.05f},
                                                           .light = {0.48f, 0.30f, 0.16f},
                                                           .boards = 8,
                                                           .seed = 23}));
  m.carpet = add_material(scene, paint_cloth("carpet", {.ground = {0.06f, 0.10f, 0.28f},
                                                        .pattern = {0.55f, 0.38f, 0.14f}}));
  m.wood = add_material(scene, paint_boards("dark wood", {.seed = 24}));
  m.gold = add_material(scene, "gold frame", {0.62f, 0.44f, 0.16f});
  m.stone = add_material(scene, paint_clouds("stone", {.dark = {0.45f, 0.44f, 0.42f},
                                                       .light = {0.70f, 0.69f, 0.66f},
                                                       .cells = 5,
                                                       .seed = 25}));
  return m;
}

void add_floors(Scene& scene, const Materials& m) {
  MeshBuilder builder;
  builder.box({-kWallX, -0.2f, -kWallZ}, {kRedX1, 0.0f, kWallZ});
  place_once(scene, builder.take("floor", m.parquet, 0.5f));
  builder.picture({9.4f, 0.01f, -2.6f}, {4.8f, 0, 0}, {0, 0, 5.2f});
  place_once(scene, builder.take("carpet", m.carpet));
}

/// Adds the outer walls and the wall with the doorway, which has one face in each room.
void add_walls(Scene& scene, const Materials& m) {
  const auto divider = [](MeshBuilder& builder, float x0, float x1) {
    builder.box({x0, 0, -kWallZ}, {x1, kWellTop, kDoorZ0});
    builder.box({x0, 0, kDoorZ1}, {x1, kWellTop, kWallZ});
    builder.box({x0, kDoorHeight, kDoorZ0}, {x1, kWellTop, kDoorZ1});
  };
  MeshBuilder builder;
  builder.box({-kWallX - kThick, 0, -kWallZ - kThick}, {-kWallX, kHeight, kWallZ + kThick});
  builder.box({-kWallX, 0, kWallZ}, {kWallX, kHeight, kWallZ + kThick});
  builder.box({-kWallX, 0, -kWallZ - kThick}, {kWallX, kHeight, -kWallZ});
  divider(builder, kWallX, kWallX + 0.5f * kThick);
  place_once(scene, builder.take("walls", m.cream, 0.4f));
  builder.box({kRedX1, 0, -kWallZ - kThick}, {kRedX1 + kThick, kRedHeight, kWallZ + kThick});
  builder.box({kWallX, 0, kWallZ}, {kRedX1, kRedHeight, kWallZ + kThick});
  builder.box({kWallX, 0, -kWallZ - kThick}, {kRedX1, kRedHeight, -kWallZ});
  divider(builder, kWallX + 0.5f * kThick, kRedX0);
  place_once(scene, builder.take("red walls", m.red, 0.4f));

  // Baseboards and the frame of the doorway.
  for (const float z : {-kWallZ, kWallZ - 0.03f}) {
    builder.box({-kWallX, 0, z}, {kWallX, 0.16f, z + 0.03f});
    builder.box({kRedX0, 0, z}, {kRedX1, 0.16f, z + 0.03f});
  }
  for (const float z : {kDoorZ0 - 0.1f, kDoorZ1 - 0.02f}) {
    builder.box({kWallX - 0.05f, 0, z}, {kRedX0 + 0.05f, kDoorHeight - 0.02f, z + 0.12f});
  }
  builder.box({kWallX - 0.05f, kDoorHeight - 0.02f, kDoorZ0 - 0.1f},
              {kRedX0 + 0.05f, kDoorHeight + 0.12f, kDoorZ1 + 0.1f});
  place_once(scene, builder.take("woodwork", m.wood, 0.8f));
}

/// Adds the ceiling with two light wells and a light panel near the top of each.
void add_skylights(Scene& scene, const Materials& m) {
  MeshBuilder builder;
  for (const float side : {-1.0f, 1.0f}) {
    builder.box({-kWallX, kHeight, std::min(side * kSkylightZ, side * (kWallZ + kThick))},
                {kWallX, kWellTop, std::max(side * kSkylightZ, side * (kWallZ + kThick))});
    const float inner = side * kSkylightX1, outer = side * kWallX;
    builder.box({std::min(inner, outer), kHeight, -kSkylightZ},
                {std::max(inner, outer), kWellTop, kSkylightZ});
    scene.lights.rects.push_back({{side * 0.5f * (kSkylightX0 + kSkylightX1), 5.1f, 0.0f},
                                  {1.8f, 0, 0},
                                  {0, 0, 0.85f},
                                  {15.0f, 15.5f, 17.0f}});
  }
  builder.box({-kSkylightX0, kHeight, -kSkylightZ}, {kSkylightX0, kWellTop, kSkylightZ});
  builder.box({-kWallX - kThick, kWellTop, -kWallZ - kThick},
              {kRedX0, kWellTop + 0.2f, kWallZ + kThick});
  builder.box({kRedX0, kRedHeight, -kWallZ - kThick},
              {kRedX1 + kThick, kRedHeight + 0.2f, kWallZ + kThick});
  place_once(scene, builder.take("ceiling", m.ceiling));
}

/// Adds a hanging tray that lights the ceiling of the red room. The rest of the room receives
/// indirect light only.
void add_uplight(Scene& scene, const Materials& m) {
  constexpr float kX = 11.9f, kZ = 0.0f, kY = 3.1f, kHalf = 0.7f;
  MeshBuilder builder;
  builder.box({kX - kHalf - 0.1f, kY - 0.12f, kZ - kHalf - 0.1f},
              {kX + kHalf + 0.1f, kY - 0.02f, kZ + kHalf + 0.1f});
  for (const float dx : {-kHalf - 0.06f, kHalf + 0.06f}) {
    for (const float dz : {-kHalf - 0.06f, kHalf + 0.06f}) {
      builder.box({kX + dx - 0.01f, kY - 0.02f, kZ + dz - 0.01f},
                  {kX + dx + 0.01f, kRedHeight, kZ + dz + 0.01f});
    }
  }
  place_once(scene, builder.take("lamp tray", m.gold));
  scene.lights.rects.push_back({{kX, kY, kZ}, {0, 0, kHalf}, {kHalf, 0, 0}, {30.0f, 19.0f, 9.0f}});
}

/// Mesh indices of a frame and of canvases of one size. All face +z, with their backs at z = 0.
struct Pictures {
  int frame = 0;
  std::array<int, 10> canvases{};
};

Pictures add_pictures(Scene& scene, const Materials& m) {
  constexpr float kHalfX = 0.8f, kHalfY = 0.6f, kRim = 0.1f;
  MeshBuilder builder;
  for (const float side : {-1.0f, 1.0f}) {
    const float x = side * (kHalfX + 0.5f * kRim), y = side * (kHalfY + 0.5f * kRim);
    builder.box({x - 0.5f * kRim, -kHalfY - kRim, 0}, {x + 0.5f * kRim, kHalfY + kRim, 0.07f});
    builder.box({-kHalfX, y - 0.5f * kRim, 0}, {kHalfX, y + 0.5f * kRim, 0.07f});
  }
  Pictures pictures;
  pictures.frame = add_mesh(scene, builder.take("frame", m.gold));
  for (std::size_t i = 0; i < pictures.canvases.size(); ++i) {
    const std::string name = "picture " + std::to_string(i + 1);
    const int material =
        add_material(scene, paint_picture(name, static_cast<std::uint32_t>(i + 40)));
    builder.picture({-kHalfX, kHalfY, 0.03f}, {2 * kHalfX, 0, 0}, {0, -2 * kHalfY, 0});
    pictures.canvases[i] = add_mesh(scene, builder.take(name, material));
  }
  return pictures;
}

/// Position of a picture, and the direction it faces in degrees about y from +z.
struct Place {
  float x, z, degrees;
};

void hang_pictures(Scene& scene, const Materials& m) {
  const Pictures pictures = add_pictures(scene, m);
  constexpr std::array<Place, 20> kPlaces{
      {{-5.6f, -4, 0},  {-2.8f, -4, 0},  {0, -4, 0},      {2.8f, -4, 0},    {5.6f, -4, 0},
       {-5.6f, 4, 180}, {-2.8f, 4, 180}, {0, 4, 180},     {2.8f, 4, 180},   {5.6f, 4, 180},
       {-8, -2, 90},    {-8, 2, 90},     {8, -1.6f, -90}, {-0.15f, 0, -90}, {0.15f, 0, 90},
       {10.2f, -4, 0},  {13.2f, -4, 0},  {10.6f, 4, 180}, {13.4f, 4, 180},  {15.5f, 0, -90}}};
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const glm::vec3 center(kPlaces[i].x, 1.75f, kPlaces[i].z);
    place(scene, pictures.frame, center, kPlaces[i].degrees);
    place(scene, pictures.canvases[i * 3 % pictures.canvases.size()], center, kPlaces[i].degrees);
  }
}

Mesh column(int material) {
  MeshBuilder builder;
  builder.lathe({.profile = {{0.36f, 0.0f},
                             {0.36f, 0.12f},
                             {0.30f, 0.18f},
                             {0.30f, 0.26f},
                             {0.25f, 0.32f},
                             {0.255f, 2.0f},
                             {0.22f, 4.5f},
                             {0.28f, 4.6f},
                             {0.26f, 4.7f},
                             {0.36f, 4.88f},
                             {0.36f, kHeight}},
                 .segments = 48,
                 .foot = glm::vec3(0.0f)});
  return builder.take("column", material, 0.5f);
}

Mesh vase_on_pedestal(int material) {
  MeshBuilder builder;
  builder.box({-0.25f, 0, -0.25f}, {0.25f, 1.0f, 0.25f});
  builder.lathe({.profile = {{0.12f, 0.0f},
                             {0.2f, 0.1f},
                             {0.24f, 0.25f},
                             {0.16f, 0.4f},
                             {0.09f, 0.5f},
                             {0.14f, 0.58f},
                             {0.0f, 0.6f}},
                 .segments = 48,
                 .foot = {0, 1.0f, 0}});
  return builder.take("vase on a pedestal", material, 0.5f);
}

void add_furniture(Scene& scene, const Materials& m) {
  MeshBuilder builder;
  // A free-standing wall in the middle.
  builder.box({-0.15f, 0, -1.5f}, {0.15f, 2.9f, 1.5f});
  place_once(scene, builder.take("partition", m.cream, 0.4f));

  builder.box({-0.9f, 0.40f, -0.25f}, {0.9f, 0.48f, 0.25f});
  for (const float x : {-0.8f, 0.7f}) builder.box({x, 0, -0.2f}, {x + 0.1f, 0.40f, 0.2f});
  const int bench = add_mesh(scene, builder.take("bench", m.wood, 1.0f));
  place(scene, bench, {-3.4f, 0, 0.0f}, 90.0f);
  place(scene, bench, {3.4f, 0, -1.0f}, 90.0f);
  place(scene, bench, {12.0f, 0, -1.4f}, 0.0f);

  const int support = add_mesh(scene, column(m.stone));
  for (const float x : {-6.9f, 6.9f}) {
    for (const float z : {-2.9f, 2.9f}) place(scene, support, {x, 0, z});
  }
  const int vase = add_mesh(scene, vase_on_pedestal(m.stone));
  place(scene, vase, {14.3f, 0, 2.4f});
  place(scene, vase, {-3.4f, 0, -2.4f});
  place(scene, vase, {3.6f, 0, 2.9f});
}

}  // namespace

Scene make_gallery() {
  Scene scene;
  scene.name = "gallery";
  scene.title = "Picture gallery";
  const Materials materials = add_materials(scene);
  add_floors(scene, materials);
  add_walls(scene, materials);
  add_skylights(scene, materials);
  add_uplight(scene, materials);
  hang_pictures(scene, materials);
  add_furniture(scene, materials);
  scene.fov_y = 50.0f;
  // The path leads past the partition and through the doorway into the red room, and looks back.
  scene.camera_path = {{0.0f, {-6.6f, 1.7f, 1.4f}, {0.0f, 1.8f, -1.0f}},
                       {2.0f, {-3.6f, 1.7f, 2.0f}, {2.0f, 1.6f, -0.4f}},
                       {4.0f, {-0.4f, 1.7f, 2.5f}, {6.0f, 1.6f, 0.6f}},
                       {6.0f, {3.4f, 1.7f, 1.6f}, {9.0f, 1.7f, 1.5f}},
                       {8.0f, {7.2f, 1.7f, 1.5f}, {12.0f, 1.6f, 0.6f}},
                       {10.0f, {9.8f, 1.7f, 1.3f}, {14.0f, 1.6f, -1.6f}},
                       {12.0f, {12.6f, 1.7f, 1.6f}, {10.5f, 1.6f, -3.4f}},
                       {14.0f, {13.0f, 1.7f, 2.6f}, {8.0f, 1.6f, 1.2f}}};
  return scene;
}

}  // namespace eigenlight
