#include "temporal/gather/even_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "frame/luminance.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

constexpr int kCell = 16;
constexpr std::array<double, 5> kTent{1.0, 2.0, 3.0, 2.0, 1.0};
constexpr double kShare = 0.02, kMost = 2.0;

// Sums over a cell, or over cells.
struct CellSum {
  double own = 0.0, light = 0.0, pixels = 0.0;

  void add(const CellSum& other, double weight) {
    own += weight * other.own;
    light += weight * other.light;
    pixels += weight * other.pixels;
  }
};

bool is_usable(const RecordedLight& light) { return light.usable != 0.0f; }
bool is_usable(const PackedColor& color) { return color.usable != 0; }
float luminance_of(const RecordedLight& light) { return luminance(light.r, light.g, light.b); }
float luminance_of(const PackedColor& color) {
  return kColorStep * luminance(static_cast<float>(color.r), static_cast<float>(color.g),
                                static_cast<float>(color.b));
}

template <typename Own>
CellSum sum_over(const Plane<Own>& own, const Planes<3>& light, const Rect& cell) {
  CellSum sum;
  for (int y = cell.y0; y < cell.y1; ++y) {
    for (int x = cell.x0; x < cell.x1; ++x) {
      const Own& from = own(x, y);
      const float after = luminance(light, x, y);
      if (!is_usable(from) || !std::isfinite(after)) continue;
      sum.own += static_cast<double>(luminance_of(from));
      sum.light += static_cast<double>(after);
      sum.pixels += 1.0;
    }
  }
  return sum;
}

// A tent over the cells of a grid, along rows and then along columns.
std::vector<CellSum> blurred(const TileGrid& grid, std::vector<CellSum> cells) {
  for (const int dx : {1, 0}) {
    std::vector<CellSum> out(cells.size());
    for (int row = 0; row < grid.rows(); ++row) {
      for (int column = 0; column < grid.columns(); ++column) {
        for (int d = -2; d <= 2; ++d) {
          const int x = column + d * dx, y = row + d * (1 - dx);
          if (x < 0 || y < 0 || x >= grid.columns() || y >= grid.rows()) continue;
          out[static_cast<std::size_t>(row * grid.columns() + column)].add(
              cells[static_cast<std::size_t>(y * grid.columns() + x)],
              kTent[static_cast<std::size_t>(d + 2)]);
        }
      }
    }
    cells = std::move(out);
  }
  return cells;
}

// The ratios of cells at a place between their centers.
class Ratios {
 public:
  Ratios(const TileGrid& grid, const std::vector<CellSum>& cells, double share)
      : columns_(grid.columns()), rows_(grid.rows()) {
    for (const CellSum& cell : cells) {
      const double floor = share * cell.pixels;
      const double ratio = (cell.own + floor) / (cell.light + floor);
      values_.push_back(std::isfinite(ratio) && cell.light + floor > 0.0
                            ? static_cast<float>(std::clamp(ratio, 1.0 / kMost, kMost))
                            : 1.0f);
    }
  }

  [[nodiscard]] float at(int x, int y) const {
    const float cx = std::clamp((static_cast<float>(x) + 0.5f) / kCell - 0.5f, 0.0f,
                                static_cast<float>(columns_ - 1));
    const float cy = std::clamp((static_cast<float>(y) + 0.5f) / kCell - 0.5f, 0.0f,
                                static_cast<float>(rows_ - 1));
    const int left = static_cast<int>(cx), top = static_cast<int>(cy);
    const int right = std::min(left + 1, columns_ - 1), low = std::min(top + 1, rows_ - 1);
    const float fx = cx - static_cast<float>(left), fy = cy - static_cast<float>(top);
    return (1.0f - fy) * ((1.0f - fx) * value(left, top) + fx * value(right, top)) +
           fy * ((1.0f - fx) * value(left, low) + fx * value(right, low));
  }

 private:
  [[nodiscard]] float value(int column, int row) const {
    return values_[static_cast<std::size_t>(row * columns_ + column)];
  }

  int columns_, rows_;
  std::vector<float> values_;
};

template <typename Own>
void even_out(const Plane<Own>& own, Planes<3>& light) {
  const TileGrid grid(own.extent(), kCell, kCell);
  std::vector<CellSum> cells(static_cast<std::size_t>(grid.count()));
  parallel_for(grid.count(), [&](int i) {
    cells[static_cast<std::size_t>(i)] = sum_over(own, light, grid.tile(i));
  });
  CellSum whole;
  for (const CellSum& cell : cells) whole.add(cell, 1.0);
  const double mean = whole.pixels > 0.0 ? whole.light / whole.pixels : 0.0;
  const Ratios ratios(grid, blurred(grid, std::move(cells)), kShare * std::max(mean, 0.0));
  parallel_for(own.height(), [&](int y) {
    for (int x = 0; x < own.width(); ++x) {
      const float ratio = ratios.at(x, y);
      for (auto& plane : light) plane(x, y) *= ratio;
    }
  });
}

}  // namespace

void even_light(const LightRecord& own, Planes<3>& light) { even_out(own, light); }
void even_light(const ColorRecord& own, Planes<3>& color) { even_out(own, color); }

}  // namespace eigenlight
