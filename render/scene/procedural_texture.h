// Procedural textures for the built-in scenes. All but pictures repeat without a seam.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "render/scene/scene.h"

namespace eigenlight {

/// Rows of stones with joints between them. Colors are linear.
struct Masonry {
  int columns = 4, rows = 8;  ///< number of stones; `rows` must be even unless `shift` is 0
  float shift = 0.5f;         ///< offset of every second row, in stones
  float joint = 0.012f;       ///< half the width of a joint, as a fraction of the image
  glm::vec3 stone{0.5f};      ///< the color of a stone lies between `stone` and `other`
  glm::vec3 other{0.5f};
  glm::vec3 joint_color{0.2f};
  bool checker = false;  ///< stones alternate between `stone` and `other`
  std::uint32_t seed = 1;
};
[[nodiscard]] Texture paint_masonry(const std::string& name, const Masonry& masonry);

/// Fractal noise between two linear colors.
struct Clouds {
  glm::vec3 dark{0.4f}, light{0.6f};
  int cells = 4;  ///< cells per side of the coarsest octave
  std::uint32_t seed = 1;
};
[[nodiscard]] Texture paint_clouds(const std::string& name, const Clouds& clouds);

/// Wooden boards along v with grain. Colors are linear.
struct Boards {
  glm::vec3 dark{0.15f, 0.08f, 0.04f}, light{0.4f, 0.24f, 0.12f};
  int boards = 6;
  std::uint32_t seed = 1;
};
[[nodiscard]] Texture paint_boards(const std::string& name, const Boards& boards);

/// Woven cloth with a border and a row of lozenges. Colors are linear.
struct Cloth {
  glm::vec3 ground{0.5f, 0.05f, 0.05f}, pattern{0.7f, 0.5f, 0.15f};
};
[[nodiscard]] Texture paint_cloth(const std::string& name, const Cloth& cloth);

/// Paints a landscape or an abstract composition, depending on `seed`.
[[nodiscard]] Texture paint_picture(const std::string& name, std::uint32_t seed);

}  // namespace eigenlight
