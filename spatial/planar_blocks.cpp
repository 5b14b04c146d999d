#include "spatial/planar_blocks.h"

#include <algorithm>
#include <numeric>

#include "frame/check.h"
#include "spatial/planar_blocks_kernel.h"

namespace eigenlight {
namespace {

int blocks_across(int pixels) { return (pixels + PlanarBlocks::kSide - 1) / PlanarBlocks::kSide; }

bool holds(const PlanarBlocks::Block& plane, const PlanarBlocks::Block& other, float tolerance) {
  return other.is_planar && std::abs(1.0f - glm::dot(plane.normal, other.normal)) <= kPlanarTurn &&
         std::abs(glm::dot(plane.normal, other.point) - plane.distance) <= tolerance * plane.depth;
}

}  // namespace

PlanarBlocks::PlanarBlocks(Extent extent, float tolerance)
    : extent_(extent),
      tiles_(stage_tiles(extent)),
      tolerance_(tolerance),
      columns_(blocks_across(extent.width)),
      rows_(blocks_across(extent.height)),
      blocks_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
      near_(blocks_.size()),
      margins_(blocks_.size()) {
  EL_CHECK(tolerance > 0.0f && tolerance <= 1.0f, "tolerance {}: expected (0, 1] of the depth",
           tolerance);
}

void PlanarBlocks::find(const Frame& guides, std::span<const std::uint8_t> chosen) {
  EL_CHECK(guides.extent() == extent_, "planar blocks made for {}x{}: got {}x{}", extent_.width,
           extent_.height, guides.extent().width, guides.extent().height);
  EL_CHECK(chosen.size() == static_cast<std::size_t>(tiles_.count()),
           "{} chosen flags for {} tiles", chosen.size(), tiles_.count());
  for_each_tile(tiles_, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; y += kSide) {
      Block* blocks = blocks_.data() +
                      static_cast<std::size_t>(y / kSide) * static_cast<std::size_t>(columns_) +
                      tile.x0 / kSide;
      if (chosen[static_cast<std::size_t>(tile.index)] == 0) {
        std::fill_n(blocks, blocks_across(tile.x1 - tile.x0), Block{});
      } else {
        find_planes(guides, tolerance_, {tile.x0, y, tile.x1, std::min(y + kSide, tile.y1), 0},
                    blocks);
      }
    }
  });
  find_margins();
}

void PlanarBlocks::clear() { std::fill(margins_.begin(), margins_.end(), std::uint8_t{0}); }

bool PlanarBlocks::lies_in_plane_of_neighbors(int column, int row) const {
  const auto at = [&](int x, int y) -> const Block& {
    return blocks_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(x)];
  };
  const Block& own = at(column, row);
  if (!own.is_planar) return false;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows_ - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns_ - 1); ++x) {
      const Block& other = at(x, y);
      if (!holds(own, other, tolerance_) || !holds(other, own, tolerance_)) return false;
    }
  }
  return true;
}

void PlanarBlocks::find_margins() {
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x);
  };
  parallel_for(rows_, [&](int y) {
    for (int x = 0; x < columns_; ++x) {
      near_[index(x, y)] = lies_in_plane_of_neighbors(x, y) ? 1 : 0;
    }
  });
  parallel_for(rows_, [&](int y) {
    for (int x = 0; x < columns_; ++x) {
      std::uint8_t margin = near_[index(x, y)];
      bool all = margin != 0;
      for (int j = std::max(y - 1, 0); all && j <= std::min(y + 1, rows_ - 1); ++j) {
        for (int i = std::max(x - 1, 0); all && i <= std::min(x + 1, columns_ - 1); ++i) {
          all = near_[index(i, j)] != 0;
        }
      }
      margins_[index(x, y)] = static_cast<std::uint8_t>(margin + (all ? 1 : 0));
    }
  });
}

std::int64_t PlanarBlocks::pixels() const {
  std::int64_t sum = 0;
  for (int row = 0; row < rows_; ++row) {
    const int height = std::min(kSide, extent_.height - row * kSide);
    for (int column = 0; column < columns_; ++column) {
      if (margins(row)[column] == 0) continue;
      sum += height * std::min(kSide, extent_.width - column * kSide);
    }
  }
  return sum;
}

}  // namespace eigenlight
