#include "temporal/correction.h"

#include <algorithm>
#include <numeric>

#include "frame/luminance.h"

namespace eigenlight {
namespace {

// Squared standard deviations of a block's mean that count as chance: 0.3 % of normal noise, some 2
// % of path-traced noise with its heavy tail; and the pixels a block must have to be asked at all.
constexpr double kBlockChance = 9.0;
constexpr int kBlock = 8, kBlockPixels = 16;

// The gate opens from 3 % significant blocks, over another 4 %: more than chance makes under a
// steady light, where the correction would only cost time. A sun that sweeps through the atrium
// makes a third.
constexpr double kGateStart = 0.03, kGateRange = 0.04;

}  // namespace

void CorrectionOptions::validate() const {
  EL_CHECK(significance >= 0.0f && significance <= 1000.0f, "significance {}: expected [0, 1000]",
           significance);
  EL_CHECK(radius == 1 || radius == 2, "correction radius {}: expected 1 or 2", radius);
  EL_CHECK(passes >= 1 && passes <= 6, "correction passes {}: expected 1 to 6", passes);
}

// 100 sigmas of luminance: the filter is to look at geometry alone.
Correction::Correction(Extent extent, const CorrectionOptions& options)
    : options_(options),
      grid_(stage_tiles(extent)),
      filter_(extent,
              {.passes = options.passes, .radius = options.radius, .luminance_sigmas = 100.0f}),
      smooth_(make_planes<3>(extent)),
      noise_(extent),
      factor_(extent),
      gate_(extent, 1),
      blocks_(static_cast<std::size_t>(gate_.grid().count())),
      wanted_(static_cast<std::size_t>(grid_.count())),
      confirmed_(blocks_.size()),
      corrected_(blocks_.size()) {
  options.validate();
}

double Correction::process(const CorrectionInputs& in, Planes<3>& prediction,
                           Plane<float>& residual) {
  for_each_tile(gate_.grid(), [&](const Tile& tile) {
    blocks_[static_cast<std::size_t>(tile.index)] = test_blocks(in, residual, tile);
  });
  skipped_ = static_cast<std::int64_t>(grid_.extent().pixels());
  if (!open_gates()) {
    if (!is_zero_) {
      for (auto& plane : smooth_) plane.fill(0.0f);
    }
    is_zero_ = true;
    return 0.0;
  }
  is_zero_ = false;
  choose_tiles();
  for_each_tile(grid_, [&](const Tile& tile) { load_residual(in, prediction, tile); });
  filter_.process(in.guides, wanted_, smooth_, noise_);
  for_each_tile(grid_, [&](const Tile& tile) { find_factor(tile); });
  for_each_tile(gate_.grid(), [&](const Tile& tile) { apply(in, tile, prediction, residual); });
  const auto sum = [](const auto& v) { return std::accumulate(v.begin(), v.end(), 0.0); };
  const double confirmed = sum(confirmed_);
  return confirmed > 0.0 ? sum(corrected_) / confirmed : 0.0;
}

Correction::Blocks Correction::test_blocks(const CorrectionInputs& in, const Plane<float>& residual,
                                           const Tile& tile) const {
  Blocks blocks;
  for (int y0 = tile.y0; y0 < tile.y1; y0 += kBlock) {
    for (int x0 = tile.x0; x0 < tile.x1; x0 += kBlock) {
      double sum = 0.0, noise = 0.0;
      int count = 0;
      for (int y = y0; y < std::min(y0 + kBlock, tile.y1); ++y) {
        for (int x = x0; x < std::min(x0 + kBlock, tile.x1); ++x) {
          if (!(in.confirmed(x, y) > 0.0f)) continue;
          sum += residual(x, y);
          noise += in.variance(x, y) * (1.0f / in.samples(x, y) + 1.0f / in.age(x, y));
          ++count;
        }
      }
      if (count < kBlockPixels) continue;
      ++blocks.all;
      blocks.significant += sum * sum > kBlockChance * noise ? 1 : 0;
    }
  }
  return blocks;
}

// False if all gates are closed.
bool Correction::open_gates() {
  const TileGrid& grid = gate_.grid();
  bool any = false;
  for (int index = 0; index < grid.count(); ++index) {
    const int column = index % grid.columns(), row = index / grid.columns();
    double all = 0.0, significant = 0.0;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows() - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns() - 1); ++x) {
        const Blocks& blocks = blocks_[static_cast<std::size_t>(y * grid.columns() + x)];
        all += blocks.all;
        significant += blocks.significant;
      }
    }
    const double share = all > 0.0 ? significant / all : 0.0;
    const double gate = std::clamp((share - kGateStart) / kGateRange, 0.0, 1.0);
    gate_.tile(index)[0] = static_cast<float>(gate - 1.0);
    any = any || gate > 0.0;
  }
  return any;
}

// A stage tile is filtered if a gate within one coefficient tile of it is open.
void Correction::choose_tiles() {
  const TileGrid& gates = gate_.grid();
  skipped_ = 0;
  for (int index = 0; index < grid_.count(); ++index) {
    const Tile tile = grid_.tile(index);
    const int left = std::max(tile.x0 / kCoefficientTile - 1, 0);
    const int right = std::min((tile.x1 - 1) / kCoefficientTile + 1, gates.columns() - 1);
    const int top = std::max(tile.y0 / kCoefficientTile - 1, 0);
    const int bottom = std::min((tile.y1 - 1) / kCoefficientTile + 1, gates.rows() - 1);
    bool open = false;
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        open = open || gate_.tile(y * gates.columns() + x)[0] > -1.0f;
      }
    }
    wanted_[static_cast<std::size_t>(index)] = open ? 1 : 0;
    skipped_ += open ? 0 : tile.pixels();
  }
}

void Correction::load_residual(const CorrectionInputs& in, const Planes<3>& prediction,
                               const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool confirmed = in.confirmed(x, y) > 0.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        smooth_[c](x, y) = confirmed ? in.light[c](x, y) - prediction[c](x, y) : 0.0f;
      }
      noise_(x, y) =
          confirmed ? in.variance(x, y) * (1.0f / in.samples(x, y) + 1.0f / in.age(x, y)) : 0.0f;
    }
  }
}

void Correction::find_factor(const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float mean = luminance(smooth_, x, y), square = mean * mean;
      const float chance = options_.significance * noise_(x, y);
      factor_(x, y) = square > chance ? 1.0f - chance / square : 0.0f;
    }
  }
}

void Correction::apply(const CorrectionInputs& in, const Tile& tile, Planes<3>& prediction,
                       Plane<float>& residual) {
  const Extent extent = grid_.extent();
  std::int64_t seen = 0, corrected = 0;
  float gate[kCoefficientTile];
  for (int y = tile.y0; y < tile.y1; ++y) {
    gate_.row({tile.x0, y, tile.x1, y + 1, tile.index}, 0, gate);
    const int top = std::max(y - 2, 0), bottom = std::min(y + 2, extent.height - 1);
    for (int x = tile.x0; x < tile.x1; ++x) {
      const int left = std::max(x - 2, 0), right = std::min(x + 2, extent.width - 1);
      float sum = 0.0f;
      for (int j = top; j <= bottom; ++j) {
        for (int i = left; i <= right; ++i) sum += factor_(i, j);
      }
      const float confirmed = in.confirmed(x, y);
      const float kept = confirmed * gate[x - tile.x0] * sum /
                         static_cast<float>((bottom - top + 1) * (right - left + 1));
      seen += confirmed > 0.0f ? 1 : 0;
      corrected += kept > 0.5f ? 1 : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        smooth_[c](x, y) *= kept;
        prediction[c](x, y) += smooth_[c](x, y);
      }
      residual(x, y) -= luminance(smooth_, x, y);
    }
  }
  confirmed_[static_cast<std::size_t>(tile.index)] = seen;
  corrected_[static_cast<std::size_t>(tile.index)] = corrected;
}

}  // namespace eigenlight
