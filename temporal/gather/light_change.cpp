#include "temporal/gather/light_change.h"

#include <cmath>

#include "frame/luminance.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

constexpr float kCell = static_cast<float>(kChangeCell);
constexpr std::array<double, 5> kBinomial{1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16};
constexpr double kMostGain = 16.0;

// Luminance at the pixel closest to a place; NaN outside.
float nearest(const Planes<3>& light, float x, float y) {
  const Extent extent = light[0].extent();
  const int px = static_cast<int>(std::lround(x)), py = static_cast<int>(std::lround(y));
  return extent.contains(px, py) ? luminance(light, px, py) : NAN;
}

struct Sums {
  double here = 0.0, there = 0.0;
};

Sums sum_cell(const Planes<3>& estimate, const Planes<3>& next, const FrameLink& link, int cx,
              int cy) {
  Sums sums;
  const int x1 = std::min((cx + 1) * kChangeCell, link.width());
  const int y1 = std::min((cy + 1) * kChangeCell, link.height());
  for (int y = cy * kChangeCell; y < y1; ++y) {
    for (int x = cx * kChangeCell; x < x1; ++x) {
      const Link& to = link(x, y);
      if (to.known == 0.0f) continue;
      const float here = luminance(estimate, x, y);
      const float there = nearest(next, static_cast<float>(x) + to.x, static_cast<float>(y) + to.y);
      if (!std::isfinite(here + there)) continue;
      sums.here += static_cast<double>(here);
      sums.there += static_cast<double>(there);
    }
  }
  return sums;
}

double smoothed(const Plane<float>& cells, int x, int y) {
  double sum = 0.0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      if (!cells.extent().contains(x + dx, y + dy)) continue;
      sum += kBinomial[static_cast<std::size_t>(dx + 2)] *
             kBinomial[static_cast<std::size_t>(dy + 2)] *
             static_cast<double>(cells(x + dx, y + dy));
    }
  }
  return sum;
}

}  // namespace

void LightChange::find(const Planes<3>& estimate, const Planes<3>& next, const FrameLink& link) {
  const Extent cells{(link.width() + kChangeCell - 1) / kChangeCell,
                     (link.height() + kChangeCell - 1) / kChangeCell};
  for (Plane<float>* plane : {&here_, &there_, &gain_}) ensure_extent(*plane, cells);
  parallel_for(cells.height, [&](int y) {
    for (int x = 0; x < cells.width; ++x) {
      const Sums sums = sum_cell(estimate, next, link, x, y);
      here_(x, y) = static_cast<float>(sums.here);
      there_(x, y) = static_cast<float>(sums.there);
    }
  });
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const double here = smoothed(here_, x, y), there = smoothed(there_, x, y);
      const bool is_known = here > 0.0 && there > 0.0;
      const double gain = is_known ? std::clamp(here / there, 1.0 / kMostGain, kMostGain) : 1.0;
      gain_(x, y) = static_cast<float>(gain);
    }
  }
}

float LightChange::at(float x, float y) const {
  const int right = gain_.width() - 1, bottom = gain_.height() - 1;
  const float cx = std::clamp((x + 0.5f) / kCell - 0.5f, 0.0f, static_cast<float>(right));
  const float cy = std::clamp((y + 0.5f) / kCell - 0.5f, 0.0f, static_cast<float>(bottom));
  const int x0 = static_cast<int>(cx), y0 = static_cast<int>(cy);
  const int x1 = std::min(x0 + 1, right), y1 = std::min(y0 + 1, bottom);
  const float above = std::lerp(gain_(x0, y0), gain_(x1, y0), cx - static_cast<float>(x0));
  const float below = std::lerp(gain_(x0, y1), gain_(x1, y1), cx - static_cast<float>(x0));
  return std::lerp(above, below, cy - static_cast<float>(y0));
}

}  // namespace eigenlight
