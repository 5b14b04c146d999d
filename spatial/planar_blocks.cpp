#include "spatial/planar_blocks.h"

#include <algorithm>

#include "frame/check.h"
#include "frame/neighbors.h"
#include "spatial/planar_blocks_kernel.h"

namespace eigenlight {
namespace {

bool holds(const PlanarBlocks::Block& plane, const PlanarBlocks::Block& other, float tolerance) {
  return other.is_planar && std::abs(1.0f - glm::dot(plane.normal, other.normal)) <= kPlanarTurn &&
         std::abs(glm::dot(plane.normal, other.point) - plane.distance) <= tolerance * plane.depth;
}

}  // namespace

PlanarBlocks::PlanarBlocks(Extent extent, float tolerance)
    : grid_(extent, kSide, kSide),
      tiles_(stage_tiles(extent)),
      tolerance_(tolerance),
      blocks_(grid_),
      near_(grid_),
      margins_(grid_) {
  EL_CHECK(tolerance > 0.0f && tolerance <= 1.0f, "tolerance {}: expected (0, 1] of the depth",
           tolerance);
}

void PlanarBlocks::find(const FrameInput& guides, const PerTile<std::uint8_t>& chosen) {
  const Extent extent = grid_.extent();
  EL_CHECK(guides.extent() == extent, "planar blocks made for {}x{}: got {}x{}", extent.width,
           extent.height, guides.extent().width, guides.extent().height);
  EL_CHECK(chosen.size() == tiles_.count(), "{} chosen flags for {} tiles", chosen.size(),
           tiles_.count());
  for_each_tile(tiles_, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; y += kSide) {
      const int first = y / kSide * grid_.columns() + tile.x0 / kSide;
      Block* blocks = &blocks_[first];
      if (chosen[tile] == 0) {
        std::fill_n(blocks, (tile.x1 - tile.x0 + kSide - 1) / kSide, Block{});
      } else {
        find_planes(guides, tolerance_, {tile.x0, y, tile.x1, std::min(y + kSide, tile.y1)},
                    blocks);
      }
    }
  });
  find_margins();
}

void PlanarBlocks::clear() { margins_.fill(0); }

bool PlanarBlocks::lies_in_plane_of_neighbors(int index) const {
  const Block& own = blocks_[index];
  if (!own.is_planar) return false;
  bool all = true;
  for_each_neighbor(grid_, index, [&](int i) {
    all = all && holds(own, blocks_[i], tolerance_) && holds(blocks_[i], own, tolerance_);
  });
  return all;
}

void PlanarBlocks::find_margins() {
  const auto for_each_block = [&](auto body) {
    parallel_for(grid_.rows(), [&](int row) {
      for (int i = row * grid_.columns(); i < (row + 1) * grid_.columns(); ++i) body(i);
    });
  };
  for_each_block([&](int index) { near_[index] = lies_in_plane_of_neighbors(index) ? 1 : 0; });
  for_each_block([&](int index) {
    std::uint8_t all = 1;
    for_each_neighbor(grid_, index, [&](int i) { all &= near_[i]; });
    margins_[index] = static_cast<std::uint8_t>(near_[index] + all);
  });
}

std::int64_t PlanarBlocks::pixels() const {
  std::int64_t sum = 0;
  for (int i = 0; i < grid_.count(); ++i) {
    if (margins_[i] > 0) sum += grid_.tile(i).pixels();
  }
  return sum;
}

}  // namespace eigenlight
