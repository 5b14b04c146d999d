// The smoothed innovation in double: gates of tiles, and cells between them.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "temporal/change/correction.h"
#include "tests/reference/atrous.h"
#include "tests/reference/coefficients.h"
#include "tests/reference/firefly_bound.h"
#include "tests/reference/pipeline/inputs.h"
#include "tests/reference/residual_cells.h"

namespace eigenlight::twin {

/// Planes that the stages between prediction and update share.
struct Residual : reference::FireflyImages {
  explicit Residual(Extent extent)
      : FireflyImages(extent),
        correction(reference::make_light(extent)),
        change(TileGrid(extent, kCoefficientTile, kCoefficientTile)) {}

  Light correction;
  PerTile<double> change;  // in [0, 1]: how certain it is that the light of a tile changed
};

/// Cells with their geometry, mean residual (0, 1, 2) and its noise (3).
struct Cells {
  explicit Cells(Extent pixels) : geometry(pixels), image(geometry.extent()) {}
  ResidualCells geometry;  // guides alone
  reference::AtrousImage image;
  [[nodiscard]] double& value(std::size_t c, int x, int y) {
    return image.values[c][image.index(x, y)];
  }
};

inline void load_cell(const CellInputs& in, int x, int y, Cells& cells) {
  const reference::Cell cell = reference::cell(in, x, y);
  const GBuffer& pixels = in.guides.surface;
  GBuffer& surface = cells.geometry.guides.surface;
  surface.id(x, y) = cell.id;
  surface.depth(x, y) =
      cell.count > 0.0 ? pixels.depth(2 * x, 2 * y) : std::numeric_limits<float>::infinity();
  for (std::size_t c = 0; c < 3; ++c) {
    surface.normal[c](x, y) = pixels.normal[c](2 * x, 2 * y);
    cells.value(c, x, y) = cell.mean[c];
  }
  cells.value(3, x, y) = cell.noise;
}

/// mean f g, with f averaged over those of 3 x 3 cells that have a confirmed pixel.
inline void weigh_cells(const CorrectionOptions& options, const TileGrid& grid,
                        const PerTile<double>& gate, Cells& cells) {
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
    const double open =
        reference::between_tiles(grid, 2 * x, 2 * y, [&](int tile) { return gate[tile]; });
    for (std::size_t c = 0; c < 3; ++c) cells.value(c, x, y) *= sum / std::max(count, 1.0) * open;
  });
}

/// g - the gate of each tile, from the share of significant blocks around.
inline PerTile<double> open_gates(const Residual& r, const TileGrid& grid) {
  PerTile<double> gate(grid), all(grid), significant(grid);
  r.brightness.each([&](int bx, int by) {
    double sum = 0.0, noise = 0.0, count = 0.0;
    reference::each_in_block(r.age.extent(), bx, by, [&](int x, int y) {
      if (std::isnan(r.innovation(x, y))) return;
      sum += r.innovation(x, y);
      noise += r.noise(x, y);
      count += 1.0;
    });
    if (count < 16.0) return;
    const int tile = by / 4 * grid.columns() + bx / 4;
    all[tile] += 1.0;
    significant[tile] += sum * sum > 9.0 * noise ? 1.0 : 0.0;
  });
  const Image tiles({grid.columns(), grid.rows()});
  tiles.each([&](int tx, int ty) {
    double a = 0.0, s = -1.0;
    tiles.each_around({tx, ty}, 1, [&](int i, int j) {
      a += all[j * grid.columns() + i];
      s += significant[j * grid.columns() + i];
    });
    gate[ty * grid.columns() + tx] = a > 0.0 ? std::clamp((s / a - 0.03) / 0.04, 0.0, 1.0) : 0.0;
  });
  return gate;
}

/// CellFilter::correct(): fills r.correction, and subtracts its luminance from r.innovation.
inline void correct(const CorrectionOptions& options, const FrameInput& frame, Residual& r) {
  const Extent extent = r.age.extent();
  const TileGrid grid(extent, kCoefficientTile, kCoefficientTile);
  r.correction = reference::make_light(extent);
  r.change = open_gates(r, grid);
  if (std::all_of(r.change.begin(), r.change.end(), [](double g) { return g == 0.0; })) return;
  const CellInputs in{frame, r.residual, r.innovation, r.age, r.samples, r.variance};
  Cells cells(extent);
  cells.geometry.set_camera(frame.camera);
  Image(cells.image.extent).each([&](int x, int y) { load_cell(in, x, y, cells); });
  const AtrousOptions filter{.passes = options.passes,
                             .luminance_sigmas = std::numeric_limits<float>::infinity()};
  for (int pass = 0; pass < options.passes; ++pass) {
    cells.image = reference::atrous_pass(cells.geometry.guides, filter, cells.image, 1 << pass);
  }
  weigh_cells(options, grid, r.change, cells);
  const auto mean = [&](std::size_t c, int x, int y) { return cells.value(c, x, y); };
  r.age.each([&](int x, int y) {
    const auto given = reference::spread(cells.geometry.guides, mean, in, x, y);
    for (std::size_t c = 0; c < 3; ++c) r.correction[c](x, y) = given[c];
    r.innovation(x, y) -= reference::luminance(given[0], given[1], given[2]);
  });
}

}  // namespace eigenlight::twin
