// Images painted by code, for the built-in scenes. All repeat without a seam, except pictures.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "render/scene/scene.h"

namespace eigenlight {

/// Stones in rows, every second row shifted by half a stone, with joints between them. Colors are
/// linear.
struct Masonry {
  int columns = 4, rows = 8;  ///< stones across and down; `rows` even unless `shift` is 0
  float shift = 0.5f;         ///< of every second row, stones
  float joint = 0.012f;       ///< half width of a joint, of the image
  glm::vec3 stone{0.5f};      ///< mean color
  glm::vec3 other{0.5f};      ///< stones vary from `stone` to this
  glm::vec3 joint_color{0.2f};
  bool checker = false;  ///< `stone` and `other` alternate; no other variation of color
  std::uint32_t seed = 1;
};
[[nodiscard]] Texture paint_masonry(const std::string& name, const Masonry& masonry);

/// Clouds between two linear colors.
struct Clouds {
  glm::vec3 dark{0.4f}, light{0.6f};
  int cells = 4;  ///< of the coarsest octave
  std::uint32_t seed = 1;
};
[[nodiscard]] Texture paint_clouds(const std::string& name, const Clouds& clouds);

/// Boards along v with grain.
struct Boards {
  glm::vec3 dark{0.15f, 0.08f, 0.04f}, light{0.4f, 0.24f, 0.12f};
  int boards = 6;
  std::uint32_t seed = 1;
};
[[nodiscard]] Texture paint_boards(const std::string& name, const Boards& boards);

/// Woven cloth with a border and a row of lozenges.
struct Cloth {
  glm::vec3 ground{0.5f, 0.05f, 0.05f}, pattern{0.7f, 0.5f, 0.15f};
};
[[nodiscard]] Texture paint_cloth(const std::string& name, const Cloth& cloth);

/// A landscape or an abstract composition, by seed.
[[nodiscard]] Texture paint_picture(const std::string& name, std::uint32_t seed);

}  // namespace eigenlight
