#include "sequences/exr/exr_colors.h"

#include <algorithm>
#include <cmath>

#include "frame/luminance.h"

namespace eigenlight {
namespace {

constexpr float kRounding = 1e-3f;

double cross(const std::array<float, 2>& a, const std::array<float, 2>& b,
             const std::array<float, 2>& c) {
  const double ux = static_cast<double>(b[0]) - static_cast<double>(a[0]);
  const double uy = static_cast<double>(b[1]) - static_cast<double>(a[1]);
  const double vx = static_cast<double>(c[0]) - static_cast<double>(a[0]);
  const double vy = static_cast<double>(c[1]) - static_cast<double>(a[1]);
  return ux * vy - uy * vx;
}

}  // namespace

ExrChromaticities rec709_chromaticities() {
  return {{0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f}, {0.3127f, 0.3290f}};
}

std::array<double, 3> luminance_weights(const ExrChromaticities& p) {
  // White is the mean of the primaries, weighed with their X + Y + Z = t; Y of each is y t. The t
  // are the barycentric coordinates of white, and Y of white is the sum of y t = y of white.
  const std::array<double, 3> t{cross(p.white, p.green, p.blue), cross(p.red, p.white, p.blue),
                                cross(p.red, p.green, p.white)};
  const double area = cross(p.red, p.green, p.blue);
  const std::array<double, 3> y{static_cast<double>(p.red[1]), static_cast<double>(p.green[1]),
                                static_cast<double>(p.blue[1])};
  std::array<double, 3> weights{};
  for (std::size_t c = 0; c < 3; ++c) {
    weights[c] = y[c] * t[c] / (area * static_cast<double>(p.white[1]));
  }
  // Primaries that no light has, such as ACES blue, may have a weight a little below 0.
  const bool is_sound = std::all_of(weights.begin(), weights.end(),
                                    [](double w) { return std::isfinite(w) && std::abs(w) < 2.0; });
  if (!is_sound || std::abs(weights[0] + weights[1] + weights[2] - 1.0) > 1e-3) {
    return {kLuminance[0], kLuminance[1], kLuminance[2]};
  }
  return weights;
}

bool same_colors(const ExrChromaticities& a, const ExrChromaticities& b) {
  const auto near = [](const std::array<float, 2>& p, const std::array<float, 2>& q) {
    return std::abs(p[0] - q[0]) <= kRounding && std::abs(p[1] - q[1]) <= kRounding;
  };
  return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) &&
         near(a.white, b.white);
}

}  // namespace eigenlight
