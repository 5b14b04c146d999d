// Parts of the built-in scene `atrium`. Units are meters and y points up. The court lies along x
// around the origin.
#pragma once

#include "render/scene/mesh_builder.h"
#include "render/scene/procedural_texture.h"
#include "render/scene/scene.h"

namespace eigenlight::atrium {

inline constexpr float kBay = 2.75f;                      ///< distance between columns
inline constexpr int kLongBays = 8;                       ///< bays along x; there are two along z
inline constexpr float kCourtX = 11.0f, kCourtZ = 2.75f;  ///< column lines, from the center
inline constexpr float kWallX = 15.0f, kWallZ = 6.0f;     ///< inner faces of the outer walls
inline constexpr float kVaseHeight = 0.62f;

/// Height of a floor, and heights above that floor where arches spring and end.
struct Storey {
  float floor, spring, top;
};
inline constexpr Storey kGround{0.0f, 3.0f, 5.0f}, kUpper{5.4f, 2.4f, 4.4f};

/// Material indices.
struct Stones {
  int blocks, plaster, marble, court_floor, gallery_floor, wood, water;
};
[[nodiscard]] Stones add_stones(Scene& scene);

/// Adds floors, outer walls, roof, beams and doors.
void add_shell(Scene& scene, const Stones& stones);
void add_fountain(Scene& scene, const Stones& stones);

// Each mesh stands at the origin; arches and rails lie along x.
[[nodiscard]] Mesh column(const Storey& storey, int material);
[[nodiscard]] Mesh pier(const Storey& storey, int material);
[[nodiscard]] Mesh arch(const Storey& storey, int material);
[[nodiscard]] Mesh baluster(int material);
[[nodiscard]] Mesh rail(int material);
[[nodiscard]] Mesh banner(int material);   ///< faces +z
[[nodiscard]] Mesh curtain(int material);  ///< faces +z
[[nodiscard]] Mesh vase(int material);
[[nodiscard]] Mesh bush(int material);
[[nodiscard]] Mesh pedestal(int material);

}  // namespace eigenlight::atrium
