// Several images of one frame that need not know the same pixels.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "spatial/atrous.h"

namespace eigenlight {
namespace {

std::uint8_t bit(std::size_t image) { return static_cast<std::uint8_t>(1u << image); }

// Whether both know the same pixels of a tile.
bool knows_same(const GBuffer& a, const GBuffer& b, const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    const auto equal = [&](const auto& one, const auto& other) {
      const auto* from = one.at(tile.x0, y);
      const std::size_t bytes = static_cast<std::size_t>(tile.width()) * sizeof(*from);
      return std::memcmp(from, other.at(tile.x0, y), bytes) == 0;
    };
    if (!equal(a.depth, b.depth) || !equal(a.id, b.id)) return false;
  }
  return true;
}

bool has_same_planes(const PlanarBlocks& a, const PlanarBlocks& b, const Tile& tile) {
  constexpr int kSide = PlanarBlocks::kSide;
  const int first = tile.x0 / kSide, last = (tile.x1 + kSide - 1) / kSide;
  for (int y = tile.y0; y < tile.y1; y += kSide) {
    const std::uint8_t *one = a.margins(y / kSide), *other = b.margins(y / kSide);
    if (!std::equal(one + first, one + last, other + first)) return false;
  }
  return true;
}

}  // namespace

void Atrous::check(std::span<const AtrousPart> parts) const {
  EL_CHECK(!parts.empty() && parts.size() <= scratch_.size(),
           "a-trous filter made for {} images: got {}", scratch_.size(), parts.size());
  for (const AtrousPart& part : parts) {
    check(part.guides, std::array{AtrousImage{part.color, part.variance}});
    EL_CHECK(part.wanted.size() == grid_.count(), "{} wanted flags for {} tiles",
             part.wanted.size(), grid_.count());
  }
}

void Atrous::find_same(std::span<const AtrousPart> parts) {
  for_each_tile(grid_, [&](const Tile& tile) {
    same_[tile] = bit(0);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      if (knows_same(parts[0].guides.surface, parts[i].guides.surface, tile)) same_[tile] |= bit(i);
    }
  });
  // Planes are sought in the wanted tiles alone.
  all_same_ = static_cast<std::uint8_t>((1u << parts.size()) - 1);
  for (int tile = 0; tile < grid_.count(); ++tile) {
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const std::uint8_t both = (wanted_[tile] >> i) & 1u, first = wanted_[tile] & 1u;
      if (both != first || (first != 0 && (same_[tile] & bit(i)) == 0)) {
        all_same_ &= static_cast<std::uint8_t>(~bit(i));
      }
    }
  }
}

// The images whose guides are the same wherever a pass reads them for a tile.
std::uint8_t Atrous::same_around(int tile) const {
  const int reach = 1 << (options_.passes - 1);
  const int columns = (reach + grid_.tile_width() - 1) / grid_.tile_width();
  const int rows = (reach + grid_.tile_height() - 1) / grid_.tile_height();
  const int x = tile % grid_.columns(), y = tile / grid_.columns();
  std::uint8_t same = same_[tile];
  for (int j = std::max(y - rows, 0); j <= std::min(y + rows, grid_.rows() - 1); ++j) {
    for (int i = std::max(x - columns, 0); i <= std::min(x + columns, grid_.columns() - 1); ++i) {
      same &= same_[j * grid_.columns() + i];
    }
  }
  return same;
}

// Finds the planes of each image, and the tiles in which it shares the weights of image 0.
void Atrous::join(std::span<const AtrousPart> parts) {
  find_same(parts);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool known = i > 0 && (all_same_ & bit(i)) != 0;
    if (!known) find_planes(parts[i].guides, parts[i].wanted, i);
  }
  for_each_tile(grid_, [&](const Tile& tile) {
    joined_[tile] = same_around(tile.index);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const bool known = (all_same_ & bit(i)) != 0;
      if (known || has_same_planes(planar_[0], planar_[i], tile)) continue;
      joined_[tile] &= static_cast<std::uint8_t>(~bit(i));
    }
  });
}

void Atrous::process(std::span<const AtrousPart> parts) {
  check(parts);
  for_each_tile(grid_, [&](const Tile& tile) {
    wanted_[tile] = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].wanted[tile] != 0) wanted_[tile] |= bit(i);
    }
  });
  join(parts);
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t planes = (all_same_ & bit(i)) != 0 ? 0 : i;
    jobs.push_back({parts[i].guides, planar_[planes], {parts[i].color, parts[i].variance}});
  }
  for (int pass = 0; pass < options_.passes; ++pass) run_pass(pass, jobs);
}

}  // namespace eigenlight
