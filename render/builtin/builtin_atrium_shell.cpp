#include <cmath>

#include "render/builtin/builtin_atrium_parts.h"
#include "render/builtin/builtin_parts.h"

namespace eigenlight::atrium {
namespace {

constexpr float kEdge = 0.35f;                      ///< overhang of slabs beyond the column line
constexpr float kRoof = kUpper.floor + kUpper.top;  ///< height of the underside of the roof
constexpr float kRoofTop = kRoof + 0.5f;

/// Adds four boxes around the court, from `inset` inside the column line to `outset` beyond the
/// inner faces of the walls.
struct Ring {
  float low, high, inset, outset;
};
void add_ring(MeshBuilder& builder, const Ring& ring) {
  const float x = kCourtX - ring.inset, z = kCourtZ - ring.inset;
  const float far_x = kWallX + ring.outset, far_z = kWallZ + ring.outset;
  builder.box({-far_x, ring.low, z}, {far_x, ring.high, far_z});
  builder.box({-far_x, ring.low, -far_z}, {far_x, ring.high, -z});
  builder.box({-far_x, ring.low, -z}, {-x, ring.high, z});
  builder.box({x, ring.low, -z}, {far_x, ring.high, z});
}

void add_floors(Scene& scene, const Stones& stones) {
  MeshBuilder builder;
  const float x = kCourtX - 0.4f, z = kCourtZ - 0.4f;
  builder.quad({-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z});
  place_once(scene, builder.take("court floor", stones.court_floor, 0.4f));
  add_ring(builder, {-0.3f, 0.0f, 0.4f, 0.0f});
  place_once(scene, builder.take("gallery floor", stones.gallery_floor, 0.4f));
  add_ring(builder, {kGround.top, kUpper.floor, kEdge, 0.0f});
  place_once(scene, builder.take("upper floor", stones.plaster, 0.5f));
  add_ring(builder, {kRoof, kRoofTop, kEdge, 0.4f});
  place_once(scene, builder.take("roof", stones.plaster, 0.5f));
}

void add_walls(Scene& scene, const Stones& stones) {
  constexpr float kThick = 0.4f;
  MeshBuilder builder;
  builder.box({-kWallX - kThick, -0.3f, kWallZ}, {kWallX + kThick, kRoof, kWallZ + kThick});
  builder.box({-kWallX - kThick, -0.3f, -kWallZ - kThick}, {kWallX + kThick, kRoof, -kWallZ});
  builder.box({-kWallX - kThick, -0.3f, -kWallZ}, {-kWallX, kRoof, kWallZ});
  builder.box({kWallX, -0.3f, -kWallZ}, {kWallX + kThick, kRoof, kWallZ});
  place_once(scene, builder.take("outer walls", stones.blocks, 0.4f));

  // A parapet up to a height of 11 m.
  const float x = kCourtX - 0.25f, z = kCourtZ - 0.25f, high = 11.0f;
  builder.box({-x - 0.3f, kRoofTop, z}, {x + 0.3f, high, z + 0.3f});
  builder.box({-x - 0.3f, kRoofTop, -z - 0.3f}, {x + 0.3f, high, -z});
  builder.box({-x - 0.3f, kRoofTop, -z}, {-x, high, z});
  builder.box({x, kRoofTop, -z}, {x + 0.3f, high, z});
  place_once(scene, builder.take("parapet", stones.blocks, 0.4f));
}

/// Adds beams under both ceilings of the long galleries, one per column.
void add_beams(Scene& scene, const Stones& stones) {
  MeshBuilder builder;
  for (int i = 0; i <= kLongBays; ++i) {
    const float x = -kCourtX + kBay * static_cast<float>(i);
    for (const float ceiling : {kGround.top, kRoof}) {
      builder.box({x - 0.14f, ceiling - 0.32f, kCourtZ + 0.2f}, {x + 0.14f, ceiling, kWallZ});
      builder.box({x - 0.14f, ceiling - 0.32f, -kWallZ}, {x + 0.14f, ceiling, -kCourtZ - 0.2f});
    }
  }
  place_once(scene, builder.take("beams", stones.wood, 1.0f));
}

/// Adds wooden doors in stone frames at every other bay of the long walls, on both storeys.
void add_doors(Scene& scene, const Stones& stones) {
  MeshBuilder leaves, frames;
  for (int i = 0; i < kLongBays; i += 2) {
    const float x = -kCourtX + kBay * (static_cast<float>(i) + 0.5f);
    for (const float floor : {kGround.floor, kUpper.floor}) {
      for (const float side : {-1.0f, 1.0f}) {
        const auto add = [&](MeshBuilder& to, glm::vec2 low, glm::vec2 high, float depth) {
          const float face = side * (kWallZ - depth), wall = side * kWallZ;
          to.box({x + low.x, floor + low.y, std::min(face, wall)},
                 {x + high.x, floor + high.y, std::max(face, wall)});
        };
        add(leaves, {-0.6f, 0.0f}, {0.6f, 2.3f}, 0.05f);
        add(frames, {-0.78f, 0.0f}, {-0.6f, 2.3f}, 0.14f);
        add(frames, {0.6f, 0.0f}, {0.78f, 2.3f}, 0.14f);
        add(frames, {-0.9f, 2.3f}, {0.9f, 2.52f}, 0.18f);
      }
    }
  }
  place_once(scene, leaves.take("doors", stones.wood, 0.8f));
  place_once(scene, frames.take("door frames", stones.marble, 0.5f));
}

void add_floor_tiles(Scene& scene, Stones& stones) {
  stones.court_floor =
      add_material(scene, paint_masonry("court tiles", {.columns = 4,
                                                        .rows = 4,
                                                        .shift = 0.0f,
                                                        .joint = 0.006f,
                                                        .stone = {0.52f, 0.46f, 0.37f},
                                                        .other = {0.34f, 0.24f, 0.18f},
                                                        .joint_color = {0.2f, 0.18f, 0.15f},
                                                        .checker = true,
                                                        .seed = 6}));
  stones.gallery_floor =
      add_material(scene, paint_masonry("gallery tiles", {.columns = 5,
                                                          .rows = 10,
                                                          .joint = 0.006f,
                                                          .stone = {0.42f, 0.22f, 0.13f},
                                                          .other = {0.50f, 0.30f, 0.18f},
                                                          .joint_color = {0.25f, 0.20f, 0.16f},
                                                          .seed = 7}));
}

}  // namespace

Stones add_stones(Scene& scene) {
  Stones stones{};
  stones.blocks =
      add_material(scene, paint_masonry("sandstone", {.columns = 4,
                                                      .rows = 6,
                                                      .joint = 0.008f,
                                                      .stone = {0.50f, 0.41f, 0.29f},
                                                      .other = {0.62f, 0.53f, 0.40f},
                                                      .joint_color = {0.30f, 0.25f, 0.19f},
                                                      .seed = 3}));
  stones.plaster = add_material(scene, paint_clouds("plaster", {.dark = {0.55f, 0.49f, 0.40f},
                                                                .light = {0.68f, 0.63f, 0.54f},
                                                                .cells = 3,
                                                                .seed = 4}));
  stones.marble = add_material(scene, paint_clouds("marble", {.dark = {0.50f, 0.46f, 0.40f},
                                                              .light = {0.74f, 0.70f, 0.62f},
                                                              .cells = 5,
                                                              .seed = 5}));
  add_floor_tiles(scene, stones);
  stones.wood = add_material(scene, paint_boards("wood", {.dark = {0.10f, 0.05f, 0.025f},
                                                          .light = {0.32f, 0.18f, 0.09f},
                                                          .boards = 6,
                                                          .seed = 8}));
  stones.water = add_material(scene, "water", {0.10f, 0.28f, 0.34f});
  return stones;
}

void add_shell(Scene& scene, const Stones& stones) {
  add_floors(scene, stones);
  add_walls(scene, stones);
  add_beams(scene, stones);
  add_doors(scene, stones);
}

}  // namespace eigenlight::atrium
