// Templates of pyramid.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "spatial/rivals/pyramid.h"

namespace eigenlight {
namespace pyramid_detail {

// A later pixel becomes the major one only if it is closer to the mean by more than rounding can
// tell, so that ties go to the first whatever the instruction set.
[[nodiscard]] inline bool is_closer(float energy, float best) { return energy < best - 1e-4f; }

// The pixels of a 2 x 2 block that exist, and which of them is the major one.
struct Block {
  std::array<const float*, 4> attributes{}, values{};
  int count = 0;
  int major = 0;
};

template <typename Edge>
[[nodiscard]] Block gather_block(const Edge& edge, const PyramidLevel& fine, int x, int y) {
  Block block;
  for (int i = 0; i < 4; ++i) {
    const int fx = 2 * x + i % 2, fy = 2 * y + i / 2;
    if (!fine.values.extent().contains(fx, fy) || !edge.exists(fine.attributes.at(fx, fy))) {
      continue;
    }
    const auto n = static_cast<std::size_t>(block.count++);
    block.attributes[n] = fine.attributes.at(fx, fy);
    block.values[n] = fine.values.at(fx, fy);
  }
  return block;
}

template <typename Edge>
void find_major(const Edge& edge, float pixel_area, Block& block) {
  std::array<float, Edge::kAttributes> mean{};
  for (int n = 0; n < block.count; ++n) {
    for (std::size_t a = 0; a < mean.size(); ++a) {
      mean[a] += block.attributes[static_cast<std::size_t>(n)][a];
    }
  }
  for (float& value : mean) value /= static_cast<float>(block.count);
  float best = std::numeric_limits<float>::infinity();
  for (int n = 0; n < block.count; ++n) {
    // From the middle of the block to the center of a pixel.
    const float distance2 = 0.5f * pixel_area;
    const float energy =
        edge.energy(mean.data(), block.attributes[static_cast<std::size_t>(n)], distance2);
    if (n > 0 && !is_closer(energy, best)) continue;
    best = energy;
    block.major = n;
  }
}

}  // namespace pyramid_detail

template <typename Edge>
void downsample_pyramid(const Edge& edge, const PyramidLevel& fine, float pixel_area,
                        PyramidLevel& coarse) {
  const auto pixel = [&](int x, int y) {
    float* values = coarse.values.at(x, y);
    float* attributes = coarse.attributes.at(x, y);
    std::fill_n(values, 4, 0.0f);
    std::fill_n(attributes, Edge::kAttributes, 0.0f);
    auto block = pyramid_detail::gather_block(edge, fine, x, y);
    if (block.count == 0) return;
    pyramid_detail::find_major(edge, pixel_area, block);
    const float* major = block.attributes[static_cast<std::size_t>(block.major)];
    float total = 0.0f;
    for (std::size_t n = 0; n < static_cast<std::size_t>(block.count); ++n) {
      const bool is_major = static_cast<int>(n) == block.major;
      // Distances within the block are those between neighbors.
      const float energy = is_major ? 0.0f : edge.energy(major, block.attributes[n], pixel_area);
      const float w = std::exp(-energy);
      total += w;
      for (int c = 0; c < 4; ++c) values[c] += w * block.values[n][c];
      if (Edge::kKeepsMajor) continue;
      for (int a = 0; a < Edge::kAttributes; ++a) attributes[a] += w * block.attributes[n][a];
    }
    for (int c = 0; c < 4; ++c) values[c] /= total;
    for (int a = 0; a < Edge::kAttributes; ++a) {
      attributes[a] = Edge::kKeepsMajor ? major[a] : attributes[a] / total;
    }
  };
  for_each_tile(stage_tiles(coarse.values.extent()), [&](const Rect& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) pixel(x, y);
    }
  });
}

template <typename Edge>
PyramidEnergies pyramid_energies(const Edge& edge, const PyramidLevel& fine,
                                 const PyramidLevel& coarse, std::array<int, 3> area_x_y) {
  const auto [area, x, y] = area_x_y;
  const float* own = fine.attributes.at(x, y);
  const float scale = static_cast<float>(area);
  // Half the side of a coarser pixel, less half a pixel of the image: section 4.1.
  const float reach = std::sqrt(scale) - 0.5f;
  const auto energy = [&](const PyramidLevel& level, int qx, int qy, float distance2) {
    if (!level.values.extent().contains(qx, qy) || !edge.exists(level.attributes.at(qx, qy))) {
      return std::numeric_limits<float>::infinity();
    }
    return edge.energy(own, level.attributes.at(qx, qy), distance2);
  };
  PyramidEnergies energies;
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    const auto n = static_cast<std::size_t>(i);
    const float distance2 = static_cast<float>(dx * dx + dy * dy) * scale;
    // The center counts in full, whatever the length of its normal.
    energies.fine[n] = i == 4 ? 0.0f : energy(fine, x + dx, y + dy, distance2);
    energies.coarse[n] = energy(coarse, x / 2 + dx, y / 2 + dy, reach * reach);
  }
  return energies;
}

}  // namespace eigenlight
