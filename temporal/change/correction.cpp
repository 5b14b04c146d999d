#include "temporal/change/correction.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "frame/luminance.h"
#include "frame/neighbors.h"
#include "frame/strips.h"

namespace eigenlight {
namespace {

// The gate starts to open at 3 % significant blocks and is open at 7 %. Under a steady light chance
// gives less, and the correction would only cost time. A moving sun in the atrium gives a third.
constexpr double kGateStart = 0.03, kGateRange = 0.04;

}  // namespace

void CorrectionOptions::validate() const {
  EL_CHECK(significance >= 0.0f && significance <= 1000.0f, "significance {}: expected [0, 1000]",
           significance);
  EL_CHECK(passes >= 1 && passes <= 6, "correction passes {}: expected 1 to 6", passes);
}

Correction::Correction(Extent extent, const CorrectionOptions& options, const TapOptions& taps)
    : options_(options),
      gate_(extent, 1),
      cells_(extent, taps),
      grid_(stage_tiles(cells_.extent())),
      correction_(make_planes<3>(extent)),
      factor_(cells_.extent()),
      block_grid_(extent, kResidualBlock, kResidualBlock),
      blocks_(block_grid_),
      tile_blocks_(gate_.grid()),
      open_(gate_.grid()),
      was_open_(gate_.grid()),
      change_(gate_.grid()),
      wanted_(grid_),
      loaded_(grid_),
      was_loaded_(grid_),
      corrected_(grid_) {
  options.validate();
}

void Correction::read_geometry(const GBuffer& surface, const Rect& area) {
  for_needed_cells(area, [&](const Tile& cells) { place_cells(surface, cells, cells_); });
}

void Correction::count_blocks(const CorrectionInputs& in, const Rect& area) {
  for (int y = area.y0; y < area.y1; y += kResidualBlock) {
    const Rect row{area.x0, y, area.x1, std::min(y + kResidualBlock, area.y1)};
    const int first = y / kResidualBlock * block_grid_.columns() + area.x0 / kResidualBlock;
    const int blocks = (area.x1 - area.x0 + kResidualBlock - 1) / kResidualBlock;
    test_blocks(in, row, std::span(&blocks_[first], static_cast<std::size_t>(blocks)));
  }
  for_needed_cells(area, [&](const Tile& cells) { load_cells(in, cells, cells_); });
}

// Calls body(cells) for the cells of the area that the last frame needed, tile by tile.
template <typename Body>
void Correction::for_needed_cells(const Rect& area, const Body& body) const {
  const int width = grid_.tile_width(), height = grid_.tile_height();
  const int right = (area.x1 + 1) / 2, bottom = (area.y1 + 1) / 2;
  for (int y0 = area.y0 / 2, y1 = 0; y0 < bottom; y0 = y1) {
    y1 = std::min((y0 / height + 1) * height, bottom);
    for (int x0 = area.x0 / 2 / kCellStep * kCellStep, x1 = 0; x0 < right; x0 = x1) {
      x1 = std::min((x0 / width + 1) * width, right);
      const int tile = y0 / height * grid_.columns() + x0 / width;
      if (loaded_[tile] != 0) body(Tile{{x0, y0, x1, y1}, tile});
    }
  }
}

void Correction::prepare(const CorrectionInputs& in) {
  std::swap(open_, was_open_);
  std::swap(loaded_, was_loaded_);
  loaded_.fill(0);
  count_tiles();
  share_ = 0.0;
  is_any_open_ = open_gates();
  for_each_tile(gate_.grid(), [&](const Tile& tile) { close_tile(tile); });
  if (!is_any_open_) return;

  choose_cells();
  cells_.set_camera(in.guides.camera);
  // Like the spreading, this reads many planes and no neighboring rows, so it goes line by line.
  for_each_segment(grid_, [&](const Tile& row) {
    if (loaded_[row] == 0 || was_loaded_[row] != 0) return;
    place_cells(in.guides.surface, row, cells_);
    load_cells(in, row, cells_);
  });
}

// Between the filter and the spreading.
void Correction::weigh() {
  const auto on = [&](const PerTile<std::uint8_t>& chosen, auto body) {
    for_each_tile(grid_, [&](const Tile& cells) {
      if (chosen[cells] != 0) body(cells);
    });
  };
  on(loaded_, [&](const Tile& cells) { find_factor(cells); });
  corrected_.fill(0);
  on(wanted_, [&](const Tile& cells) { weigh_cells(cells); });
  std::int64_t confirmed = 0;
  for (const ResidualBlock& block : blocks_) confirmed += block.confirmed;
  const auto corrected = std::accumulate(corrected_.begin(), corrected_.end(), std::int64_t{0});
  share_ = confirmed > 0 ? static_cast<double>(corrected) / static_cast<double>(confirmed) : 0.0;
}

void Correction::count_tiles() {
  constexpr int kSide = kCoefficientTile / kResidualBlock;
  tile_blocks_.fill({});
  for (int i = 0; i < block_grid_.count(); ++i) {
    const int x = i % block_grid_.columns() / kSide, y = i / block_grid_.columns() / kSide;
    TileBlocks& tile = tile_blocks_[y * gate_.grid().columns() + x];
    const ResidualBlock& block = blocks_[i];
    tile.all += block.is_asked ? 1 : 0;
    tile.significant += block.is_significant ? 1 : 0;
  }
}

// Returns false if all gates are closed. A tile is open if its gate or that of a neighbor is open,
// because gates are interpolated.
bool Correction::open_gates() {
  const TileGrid& grid = gate_.grid();
  open_.fill(0);
  for (int index = 0; index < grid.count(); ++index) {
    double all = 0.0, significant = 0.0;
    for_each_neighbor(grid, index, [&](int tile) {
      all += tile_blocks_[tile].all;
      significant += tile_blocks_[tile].significant;
    });
    // One block is subtracted: in a small image a single block, by chance, would open the gate.
    const double share = all > 0.0 ? (significant - 1.0) / all : 0.0;
    const double change = std::clamp((share - kGateStart) / kGateRange, 0.0, 1.0);
    change_[index] = static_cast<float>(change);
    const double gate = options_.gated ? change : 1.0;
    gate_.tile(index)[0] = static_cast<float>(gate - 1.0);
    if (gate > 0.0) for_each_neighbor(grid, index, [&](int tile) { open_[tile] = 1; });
  }
  skipped_ = 0;
  for (int index = 0; index < grid.count(); ++index) {
    if (!is_open(index)) skipped_ += grid.tile(index).pixels();
  }
  return skipped_ < static_cast<std::int64_t>(grid.extent().pixels());
}

// Clears the correction of an earlier frame.
void Correction::close_tile(const Tile& tile) {
  if (is_open(tile.index) || was_open_[tile] == 0) return;
  for (auto& plane : correction_) fill_rect(plane, tile, 0.0f);
}

// Marks the cells that pixels of open tiles read (to be filtered), and the cells that the filter
// reads from there (to be loaded).
void Correction::choose_cells() {
  wanted_.fill(0);
  const auto mark = [&](PerTile<std::uint8_t>& chosen, const Rect& area, int reach) {
    const int left = std::max(area.x0 - reach, 0) / grid_.tile_width();
    const int right = (area.x1 + reach - 1) / grid_.tile_width();
    const int top = std::max(area.y0 - reach, 0) / grid_.tile_height();
    const int bottom = (area.y1 + reach - 1) / grid_.tile_height();
    for (int y = top; y <= std::min(bottom, grid_.rows() - 1); ++y) {
      for (int x = left; x <= std::min(right, grid_.columns() - 1); ++x) {
        chosen[y * grid_.columns() + x] = 1;
      }
    }
  };
  const TileGrid& tiles = gate_.grid();
  for (int index = 0; index < tiles.count(); ++index) {
    if (!is_open(index)) continue;
    const Tile tile = tiles.tile(index);
    mark(wanted_, {tile.x0 / 2, tile.y0 / 2, (tile.x1 + 1) / 2, (tile.y1 + 1) / 2}, 1);
  }
  // One tap to each side, 1 + 2 + 4 + ... cells apart; one more for the mean of factors.
  const int reach = (1 << options_.passes);
  for (int index = 0; index < grid_.count(); ++index) {
    if (wanted_[index] != 0) mark(loaded_, grid_.tile(index), reach);
  }
}

void Correction::find_factor(const Tile& cells) {
  for (int y = cells.y0; y < cells.y1; ++y) {
    for (int x = cells.x0; x < cells.x1; ++x) {
      const float mean = luminance(cells_.mean, x, y), square = mean * mean;
      const float chance = options_.significance * cells_.noise(x, y);
      factor_(x, y) = square > chance ? 1.0f - chance / square : 0.0f;
    }
  }
}

// Sums f and the number of cells with a confirmed pixel over 3 x 3 windows, for the cells [x0, x0 +
// count) of a row. Cells outside the image count as 0.
void Correction::sum_windows(int x0, int y, int count, WindowRow& sums) const {
  const Extent extent = cells_.extent();
  const int first = std::max(x0 - 1, 0), last = std::min(x0 + count + 1, extent.width);
  const int shift = first - (x0 - 1);
  WindowRow columns{};
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, extent.height - 1); ++j) {
    const float *factor = factor_.at(first, j), *confirmed = cells_.count.at(first, j);
    float *sum = columns.factor + shift, *known = columns.known + shift;
    for (int i = 0; i < last - first; ++i) {
      sum[i] += factor[i];
      known[i] += confirmed[i] > 0.0f ? 1.0f : 0.0f;
    }
  }
  const auto three = [count](const float* from, float* to) {
    for (int i = 0; i < count; ++i) to[i] = from[i] + from[i + 1] + from[i + 2];
  };
  three(columns.factor, sums.factor);
  three(columns.known, sums.known);
}

// mean <- mean f g
void Correction::weigh_cells(const Tile& cells) {
  constexpr int kStep = kCoefficientTile / 2;
  CoefficientRows gate;
  WindowRow windows;
  std::int64_t corrected = 0;
  for (int y = cells.y0; y < cells.y1; ++y) {
    for (int x0 = cells.x0; x0 < cells.x1; x0 += kStep) {
      const int count = std::min(kStep, cells.x1 - x0);
      gate_.rows({2 * x0, 2 * y, 2 * (x0 + count), 2 * y + 1}, 1, gate);
      sum_windows(x0, y, count, windows);
      const float* confirmed = cells_.count.at(x0, y);
      float kept[kStep];
      for (int i = 0; i < count; ++i) {
        kept[i] = gate[0][2 * i] * windows.factor[i] / std::max(windows.known[i], 1.0f);
        corrected += kept[i] > 0.5f ? static_cast<std::int64_t>(confirmed[i]) : 0;
      }
      for (auto& plane : cells_.mean) {
        float* mean = plane.at(x0, y);
        for (int i = 0; i < count; ++i) mean[i] *= kept[i];
      }
    }
  }
  corrected_[cells] = corrected;
}

}  // namespace eigenlight
