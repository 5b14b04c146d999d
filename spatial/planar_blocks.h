// Finds blocks of pixels that lie in one plane, where weights of normals and plane distances are 1.
#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "frame/tiles.h"

namespace eigenlight {

/// Finds the blocks of 8 x 8 pixels that lie in one plane together with the blocks around them. A
/// block is planar if of all its pixels q, and its first pixel p,
///   id_q != 0,  |1 - N_p . N_q| <= 1e-6,  |N_p . (X_q - X_p)| <= tolerance * depth_p,
/// and two planar blocks lie in one plane if this holds for the first pixel of each and the other's
/// p. Normals that are not unit vectors and invalid depths lie in no plane.
///
/// Each block is compared with its own neighbors only, so that a margin of two blocks may be off by
/// twice the tolerance.
class PlanarBlocks {
 public:
  static constexpr int kSide = 8;        ///< pixels
  static constexpr int kMostMargin = 2;  ///< blocks

  /// `tolerance` in (0, 1], of the depth. Throws std::invalid_argument if it is not.
  PlanarBlocks(Extent extent, float tolerance);

  /// Looks at the tiles of stage_tiles() with chosen(tile index) != 0; blocks of others are not
  /// planar. Throws std::invalid_argument if extents or the number of tiles differ.
  void find(const FrameInput& guides, const PerTile<std::uint8_t>& chosen);
  /// No block is planar.
  void clear();

  /// For each block of a row of blocks how many blocks around it, in all directions and as far as
  /// the image goes, lie in its plane: 0 to kMostMargin.
  [[nodiscard]] const std::uint8_t* margins(int row) const {
    return &margins_[row * grid_.columns()];
  }
  /// Pixels in blocks with a margin of at least 1.
  [[nodiscard]] std::int64_t pixels() const;

  /// The plane of a block, relative to the eye.
  struct Block {
    bool is_planar = false;
    float depth = 0.0f;      ///< of its first pixel
    float distance = 0.0f;   ///< N . X
    glm::vec3 normal{0.0f};  ///< N
    glm::vec3 point{0.0f};   ///< X
  };

 private:
  [[nodiscard]] bool lies_in_plane_of_neighbors(int index) const;
  void find_margins();

  TileGrid grid_;   // of blocks
  TileGrid tiles_;  // of stage_tiles()
  float tolerance_;
  PerTile<Block> blocks_;
  PerTile<std::uint8_t> near_, margins_;  // near: 1 where all neighbors lie in the plane
};

}  // namespace eigenlight
