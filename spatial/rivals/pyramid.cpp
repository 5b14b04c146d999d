#include "spatial/rivals/pyramid.h"

#include <cmath>

namespace eigenlight {
namespace {

// Sums of 18 such values, whose weights are at most 1, stay finite.
constexpr float kLargestValue = 1e36f;

}  // namespace

std::vector<PyramidLevel> make_pyramid_levels(Extent extent, int attributes, int passes) {
  std::vector<PyramidLevel> levels;
  for (int l = 0; l <= passes; ++l) {
    levels.push_back(
        {Plane<float>(extent, attributes), Plane<float>(extent, 4), Plane<float>(extent, 4)});
    extent = {(extent.width + 1) / 2, (extent.height + 1) / 2};
  }
  return levels;
}

void load_pyramid_values(const Planes<3>& signal, const Plane<float>& weight, const Rect& tile,
                         Plane<float>& values) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float w = weight(x, y);
      float* value = values.at(x, y);
      bool used = w > 0.0f && w < kLargestValue;
      for (const auto& plane : signal) used = used && std::abs(w * plane(x, y)) < kLargestValue;
      for (std::size_t c = 0; c < 3; ++c) value[c] = used ? w * signal[c](x, y) : 0.0f;
      value[3] = used ? w : 0.0f;
    }
  }
}

void store_pyramid_result(const Plane<float>& result, const Rect& tile, Planes<3>& out) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float* value = result.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        out[c](x, y) = value[3] > 0.0f ? value[c] / value[3] : 0.0f;
      }
    }
  }
}

void blend_pyramid_pixel(const PyramidEnergies& energies, const PyramidPass& pass,
                         std::vector<PyramidLevel>& levels, std::array<int, 3> level_x_y) {
  const auto [level, x, y] = level_x_y;
  PyramidLevel& fine = levels[static_cast<std::size_t>(level)];
  const PyramidLevel& coarse = levels[static_cast<std::size_t>(level) + 1];
  std::array<float, 4> sum{}, mean{};  // of Eq. 2, and of the finer samples by their range function
  float total = 0.0f, alike = 0.0f, moved = 0.0f;
  const auto add = [](std::array<float, 4>& to, float w, const float* from) {
    for (std::size_t c = 0; c < 4; ++c) to[c] += w * from[c];
  };
  for (int i = 0; i < 9; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    if (std::isfinite(energies.fine[n])) {
      const float range = std::exp(-energies.fine[n]);
      const float* from = fine.values.at(x + dx, y + dy);
      add(sum, pass.fine[n] * range, from);
      add(mean, range, from);
      total += pass.fine[n] * range;
      alike += range;
    }
    if (std::isfinite(energies.coarse[n])) {
      const float interpolation =
          pyramid_interpolation(x % 2, dx) * pyramid_interpolation(y % 2, dy);
      const float basic = interpolation * std::exp(-energies.coarse[n]) * pass.coarse[n];  // Eq. 2e
      const float kept = basic * std::exp(-pass.gamma * energies.coarse[n]);               // Eq. 2c
      add(sum, kept, coarse.result.at(x / 2 + dx, y / 2 + dy));
      total += kept;
      moved += basic - kept;
    }
  }
  // Eq. 2d. The center's range function is 1, so that `alike` is at least 1.
  add(sum, moved / alike, mean.data());
  total += moved;
  float* result = fine.result.at(x, y);
  for (std::size_t c = 0; c < 4; ++c) result[c] = sum[c] / total;
}

}  // namespace eigenlight
