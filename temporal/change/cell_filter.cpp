#include <algorithm>
#include <limits>
#include <vector>

#include "frame/strips.h"
#include "temporal/change/correction.h"

namespace eigenlight {
namespace {

std::uint8_t bit(std::size_t layer) { return static_cast<std::uint8_t>(1u << layer); }

// Looks at geometry alone.
AtrousOptions cell_filter(const CorrectionOptions& options) {
  options.validate();
  return {.passes = options.passes,
          .luminance_sigmas = std::numeric_limits<float>::infinity(),
          .skip_planar = options.skip_planar};
}

}  // namespace

CellFilter::CellFilter(Extent pixels, const CorrectionOptions& options, int layers)
    : cell_grid_(stage_tiles({(pixels.width + 1) / 2, (pixels.height + 1) / 2})),
      atrous_(cell_grid_.extent(), cell_filter(options), std::min(layers, Atrous::kMostImages)) {}

void CellFilter::correct(Layers layers) {
  std::vector<CorrectionLayer> open;
  for (const CorrectionLayer& layer : layers) {
    if (layer.correction.is_any_open_) open.push_back(layer);
  }
  for (Layers left = open; !left.empty();) {
    const Layers some = left.first(std::min(left.size(), std::size_t{Atrous::kMostImages}));
    correct_some(some);
    left = left.subspan(some.size());
  }
}

// Of open layers as many as the filter takes at once.
void CellFilter::correct_some(Layers open) {
  std::vector<AtrousPart> parts;
  for (const CorrectionLayer& layer : open) {
    Correction& own = layer.correction;
    parts.push_back({own.cells_.guides, own.wanted_, own.cells_.mean, own.cells_.noise});
  }
  atrous_.process(parts);
  for (const CorrectionLayer& layer : open) layer.correction.weigh();
  spread(open);
}

// The layers whose cells around a tile of the coefficients' grid are those of the first one.
std::uint8_t CellFilter::joined(const Tile& pixels) const {
  const int column = pixels.x0 / 2 / cell_grid_.tile_width();
  const int row = pixels.y0 / 2 / cell_grid_.tile_height();
  return atrous_.joined(row * cell_grid_.columns() + column);
}

// This reads many planes and no neighboring rows of pixels, so it goes line by line. Parts of a row
// in which the same layers are open and joined come at once.
void CellFilter::spread(Layers open) const {
  const TileGrid& grid = open.front().correction.gate_.grid();
  const auto open_in = [&](const Tile& part) {
    std::uint8_t found = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (open[i].correction.is_open(part.index)) found |= bit(i);
    }
    return found;
  };
  for_each_strip(grid, [&](const Strip& strip) {
    for_each_band(strip, 1, [&](const Strip& row) {
      Tile area = row.area;
      area.x1 = area.x0;
      std::uint8_t which = 0;
      for_each_part(grid, row, [&](const Tile& part) {
        const std::uint8_t now = open_in(part);
        if (area.x1 == part.x0 && now == which && joined(part) == joined(area)) {
          area.x1 = part.x1;
          return;
        }
        spread_row(open, area, which);
        area = part;
        which = now;
      });
      spread_row(open, area, which);
    });
  });
}

void CellFilter::spread_row(Layers open, const Tile& area, std::uint8_t which) const {
  if (which == 0) return;
  const std::uint8_t together = which & joined(area);
  std::vector<SpreadLayer> shared;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if ((which & bit(i)) == 0) continue;
    Correction& own = open[i].correction;
    const SpreadLayer layer{own.cells_, {own.correction_, open[i].innovation}};
    if ((together & bit(i)) != 0) {
      shared.push_back(layer);
    } else {
      spread_cells(std::span(&layer, 1), open[i].guides, area);
    }
  }
  if (!shared.empty()) spread_cells(shared, open.front().guides, area);
}

}  // namespace eigenlight
