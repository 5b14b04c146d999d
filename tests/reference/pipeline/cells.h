// Cells of 2 x 2 pixels of the residual, smoothed and brought back, in double.
#pragma once

#include <limits>

#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"
#include "tests/reference/pipeline/correction.h"

namespace eigenlight::twin {

inline glm::dvec3 normal_at(const FrameInput& frame, int x, int y) {
  const auto& n = frame.surface.normal;
  return {n[0](x, y), n[1](x, y), n[2](x, y)};
}

/// Cells with their geometry, mean residual (0, 1, 2) and its noise (3).
struct Cells {
  explicit Cells(Extent pixels) : geometry(pixels), image(geometry.extent()) {}
  ResidualCells geometry;  // guides alone
  reference::AtrousImage image;
  [[nodiscard]] double& value(std::size_t c, int x, int y) {
    return image.values[c][image.index(x, y)];
  }
};

inline void load_cell(const Residual& r, const FrameInput& frame, glm::ivec2 cell, Cells& cells) {
  const glm::ivec2 first = 2 * cell;
  const std::uint32_t id = frame.surface.id(first.x, first.y);
  double count = 0.0, noise = 0.0;
  std::array<double, 3> sum{};
  for (int y = first.y; y < std::min(first.y + 2, r.value.extent.height); ++y) {
    for (int x = first.x; x < std::min(first.x + 2, r.value.extent.width); ++x) {
      const double cosine = glm::dot(normal_at(frame, first.x, first.y), normal_at(frame, x, y));
      const bool same =
          glm::ivec2(x, y) == first || cosine >= static_cast<double>(TapOptions{}.normal_cosine);
      if (!(r.confirmed(x, y) > 0.0) || frame.surface.id(x, y) != id || !same) continue;
      count += 1.0;
      noise += r.noise(x, y);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += r.light[c](x, y) - r.prediction[c](x, y);
    }
  }
  GBuffer& surface = cells.geometry.guides.surface;
  surface.id(cell.x, cell.y) = count > 0.0 ? id : 0;
  surface.depth(cell.x, cell.y) =
      count > 0.0 ? frame.surface.depth(first.x, first.y) : std::numeric_limits<float>::infinity();
  for (std::size_t c = 0; c < 3; ++c) {
    surface.normal[c](cell.x, cell.y) = frame.surface.normal[c](first.x, first.y);
    cells.value(c, cell.x, cell.y) = sum[c] / std::max(count, 1.0);
  }
  cells.value(3, cell.x, cell.y) = noise / std::max(count * count, 1.0);
}

/// mean f g, with f averaged over those of 3 x 3 cells that have a confirmed pixel.
inline void weigh_cells(const CorrectionOptions& options, const TileValues& gate, Cells& cells) {
  Image factor(cells.image.extent);
  factor.each([&](int x, int y) {
    const double mean = cells.image.luminance(x, y);
    const double chance = options.significance * cells.value(3, x, y);
    factor(x, y) = mean * mean > chance ? 1.0 - chance / (mean * mean) : 0.0;
  });
  factor.each([&](int x, int y) {
    double sum = 0.0, count = 0.0;
    factor.each_around({x, y}, 1, [&](int i, int j) {
      sum += factor(i, j);
      count += cells.geometry.guides.surface.id(i, j) != 0 ? 1.0 : 0.0;
    });
    const double kept = sum / std::max(count, 1.0) * gate.at(2 * x, 2 * y);
    for (std::size_t c = 0; c < 3; ++c) cells.value(c, x, y) *= kept;
  });
}

/// What a confirmed pixel takes of the four cells around.
inline std::array<double, 3> take_cells(const FrameInput& frame, Cells& cells, int x, int y) {
  const Camera& camera = frame.camera;
  const glm::dvec3 normal = normal_at(frame, x, y);
  const glm::dvec3 view = glm::dmat3(camera.world_to_view) * normal;
  const auto along = [&](int px, int py) {
    return glm::dot(glm::dvec2(view), (glm::dvec2(px, py) + 0.5 - glm::dvec2(camera.center)) /
                                          static_cast<double>(camera.focal)) +
           view.z;
  };
  const GBuffer& surface = cells.geometry.guides.surface;
  const double depth = frame.surface.depth(x, y);
  const TapOptions taps;
  std::array<double, 3> sum{};
  double total = 0.0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const int cx = std::clamp(x / 2 + i * (2 * (x % 2) - 1), 0, cells.image.extent.width - 1);
      const int cy = std::clamp(y / 2 + j * (2 * (y % 2) - 1), 0, cells.image.extent.height - 1);
      if (surface.id(cx, cy) != frame.surface.id(x, y)) continue;
      const double off =
          std::abs(surface.depth(cx, cy) * along(2 * cx, 2 * cy) - depth * along(x, y));
      const bool same = off <= taps.plane_distance * depth &&
                        glm::dot(normal, normal_at(cells.geometry.guides, cx, cy)) >=
                            static_cast<double>(taps.normal_cosine);
      const double weight = (i == 0 ? 0.75 : 0.25) * (j == 0 ? 0.75 : 0.25) * (same ? 1.0 : 1e-3);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * cells.value(c, cx, cy);
      total += weight;
    }
  }
  for (double& value : sum) value = total > 0.0 ? value / total : 0.0;
  return sum;
}

/// Correction::process: adds to the prediction, takes from the residual, leaves what it added.
inline void correct(const CorrectionOptions& options, const FrameInput& frame, Residual& r) {
  for (auto& plane : r.correction) plane = Image(plane.extent);
  const TileValues gate = r.change = open_gates(r);
  if (std::all_of(gate.values.begin(), gate.values.end(), [](double g) { return g == 0.0; })) {
    return;
  }
  Cells cells(r.value.extent);
  cells.geometry.set_camera(frame.camera);
  Image(cells.image.extent).each([&](int x, int y) { load_cell(r, frame, {x, y}, cells); });
  const AtrousOptions filter{.passes = options.passes,
                             .radius = 1,
                             .luminance_sigmas = std::numeric_limits<float>::infinity()};
  for (int pass = 0; pass < options.passes; ++pass) {
    cells.image = reference::atrous_pass(cells.geometry.guides, filter, cells.image, 1 << pass);
  }
  weigh_cells(options, gate, cells);
  r.value.each([&](int x, int y) {
    if (!(r.confirmed(x, y) > 0.0)) return;
    const auto given = take_cells(frame, cells, x, y);
    for (std::size_t c = 0; c < 3; ++c) {
      r.correction[c](x, y) = given[c];
      r.prediction[c](x, y) += given[c];
    }
    r.value(x, y) -= luminance(r.correction, x, y);
  });
}

}  // namespace eigenlight::twin
