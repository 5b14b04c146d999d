#include "sequences/conventions/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/check.h"
#include "frame/luminance.h"
#include "sequences/conventions/background.h"
#include "sequences/conventions/reprojection.h"
#include "sequences/conventions/sampling.h"

namespace eigenlight {
namespace {

constexpr double kSampled = 40000;
// Noise below that share of the mean is none that anyone would filter.
constexpr double kLeastNoise = 0.02;
// Pixels that stand still, of which more than half must agree (without motion: nearly all).
constexpr int kFewestStill = 100;
constexpr double kStill = 0.01, kMostAgree = 0.5, kNearlyAllAgree = 0.9;
// Equal but for half's rounding.
constexpr float kEqual = 1e-3f;
constexpr int kFewestSmooth = 500;
// Correlation of neighbors: a box filter of one pixel leaves 0, a tent two pixels wide 1/4, the
// mean of 2 x 2 pixels 1/2; what a denoiser leaves is nearly smooth.
constexpr double kCorrelated = 0.15, kSmoothed = 0.7;
constexpr double kCut = 0.6;

// Calls body(x, y) on a grid that keeps `border` pixels away from the edges.
template <typename Body>
void for_grid(Extent extent, int border, const Body& body) {
  const int step = grid_step(extent, kSampled);
  for (int y = border; y < extent.height - border; y += step) {
    for (int x = border; x < extent.width - border; x += step) body(x, y);
  }
}

// Luminances of the square around a pixel, and their mean and variance.
template <int Reach>
struct Window {
  static constexpr int kSide = 2 * Reach + 1;
  double value[kSide * kSide] = {};
  double mean = 0.0, variance = 0.0;

  [[nodiscard]] double at(int dx, int dy) const { return value[(dy + Reach) * kSide + dx + Reach]; }
  [[nodiscard]] bool is_noisy() const {
    return mean > 0.0 && variance > kLeastNoise * kLeastNoise * mean * mean;
  }
};

// False where a value is not finite.
template <int Reach, typename Get>
bool read_window(int x, int y, const Get& get, Window<Reach>& window) {
  constexpr int kCount = Window<Reach>::kSide * Window<Reach>::kSide;
  int i = 0;
  double sum = 0.0;
  for (int dy = -Reach; dy <= Reach; ++dy) {
    for (int dx = -Reach; dx <= Reach; ++dx) {
      const double value = get(x + dx, y + dy);
      if (!std::isfinite(value)) return false;
      window.value[i++] = value;
      sum += value;
    }
  }
  window.mean = sum / kCount;
  for (const double value : window.value) {
    window.variance += (value - window.mean) * (value - window.mean) / (kCount - 1);
  }
  return true;
}

bool all_finite(const Planes<3>& planes, int x, int y) {
  return std::isfinite(planes[0](x, y)) && std::isfinite(planes[1](x, y)) &&
         std::isfinite(planes[2](x, y));
}

// NaN where a channel is not finite or too large to be squared.
double finite_luminance(const Planes<3>& light, const LuminanceWeights& weights, int x, int y) {
  if (!all_finite(light, x, y)) return std::nan("");
  double value = 0.0;
  for (std::size_t c = 0; c < 3; ++c) value += weights[c] * static_cast<double>(light[c](x, y));
  return std::abs(value) < 1e18 ? value : std::nan("");
}

bool is_equal(const Planes<3>& a, const Planes<3>& b, int x, int y) {
  for (int c = 0; c < 3; ++c) {
    const float p = a[c](x, y), q = b[c](x, y);
    if (!std::isfinite(p) || !std::isfinite(q)) return false;
    if (std::abs(p - q) > kEqual * std::max(std::abs(p), std::abs(q))) return false;
  }
  return true;
}

bool is_alike(const Planes<3>& planes, int x0, int y0, int x1, int y1, float width) {
  if (planes[0].empty()) return true;
  if (!all_finite(planes, x0, y0) || !all_finite(planes, x1, y1)) return false;
  for (int c = 0; c < 3; ++c) {
    if (std::abs(planes[c](x0, y0) - planes[c](x1, y1)) > width) return false;
  }
  return true;
}

bool is_near(const Plane<float>& depth, int x0, int y0, int x1, int y1) {
  if (depth.empty()) return true;
  const float a = depth(x0, y0), b = depth(x1, y1);
  return !is_background(a) && !is_background(b) && std::abs(a - b) < 0.1f * a;
}

// Whether the corners and the middles of the sides of a 5 x 5 window are the same surface.
bool is_smooth(const RawGuides& guides, int x, int y) {
  for (int dy = -2; dy <= 2; dy += 2) {
    for (int dx = -2; dx <= 2; dx += 2) {
      if (!is_near(guides.depth, x, y, x + dx, y + dy)) return false;
      if (!is_alike(guides.normal, x, y, x + dx, y + dy, 0.15f)) return false;
      if (!is_alike(guides.albedo, x, y, x + dx, y + dy, 0.1f)) return false;
    }
  }
  return true;
}

// Noise over mean: Immerkaer (1996), whose mask does not answer to slopes, in each window.
template <typename Get>
std::vector<double> relative_noise(Extent extent, const Get& get) {
  std::vector<double> noise;
  for_grid(extent, 1, [&](int x, int y) {
    Window<1> w;
    if (!read_window(x, y, get, w) || w.mean == 0.0) return;
    const double corners = w.at(-1, -1) + w.at(1, -1) + w.at(-1, 1) + w.at(1, 1);
    const double sides = w.at(0, -1) + w.at(-1, 0) + w.at(1, 0) + w.at(0, 1);
    noise.push_back(std::abs(corners - 2.0 * sides + 4.0 * w.at(0, 0)) / 6.0 / std::abs(w.mean));
  });
  return noise;
}

}  // namespace

std::optional<std::string> check_frozen_seeds(const Planes<3>& before, const Planes<3>& now,
                                              const Planes<2>& motion,
                                              const LuminanceWeights& weights) {
  const Extent extent = now[0].extent();
  EL_CHECK(before[0].extent() == extent, "light of two frames: {}x{} and {}x{}", extent.width,
           extent.height, before[0].width(), before[0].height());
  const bool has_motion = !motion[0].empty();
  int still = 0, equal = 0;
  for_grid(extent, 1, [&](int x, int y) {
    if (has_motion) {
      const float mx = motion[0](x, y), my = motion[1](x, y);
      if (!std::isfinite(mx) || !std::isfinite(my)) return;
      if (std::abs(mx) > kStill || std::abs(my) > kStill) return;
    }
    Window<1> window;
    const auto get = [&](int i, int j) { return finite_luminance(now, weights, i, j); };
    if (!read_window(x, y, get, window) || !window.is_noisy()) return;
    // No sample found light: equal in any two frames.
    if (get(x, y) == 0.0) return;
    ++still;
    if (is_equal(before, now, x, y)) ++equal;
  });
  const double share = still > 0 ? static_cast<double>(equal) / still : 0.0;
  if (still < kFewestStill || share < (has_motion ? kMostAgree : kNearlyAllAgree)) {
    return std::nullopt;
  }
  return fmt::format(
      "frozen seeds: {:.0f} % of the pixels that stand still have the same noise as one frame ago, "
      "so "
      "history cannot lower it; render every frame with a seed of its own",
      100.0 * share);
}

std::optional<double> noise_correlation(const Planes<3>& light, const RawGuides& guides,
                                        const LuminanceWeights& weights) {
  double product = 0.0;
  int count = 0;
  const auto get = [&](int i, int j) { return finite_luminance(light, weights, i, j); };
  for_grid(light[0].extent(), 2, [&](int x, int y) {
    if (!is_smooth(guides, x, y)) return;
    Window<2> window;
    if (!read_window(x, y, get, window) || !window.is_noisy()) return;
    // Over all pairs of neighbors in the window.
    double sum = 0.0;
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx < 2; ++dx) {
        sum += (window.at(dx, dy) - window.mean) * (window.at(dx + 1, dy) - window.mean);
        sum += (window.at(dy, dx) - window.mean) * (window.at(dy, dx + 1) - window.mean);
      }
    }
    product += sum / 40.0 / (window.variance * 24.0 / 25.0);
    ++count;
  });
  if (count < kFewestSmooth) return std::nullopt;
  // About the mean of 25 values, independent noise has the correlation -1 / 24.
  return product / count + 1.0 / 24.0;
}

std::optional<std::string> check_correlated_noise(const Planes<3>& light, const RawGuides& guides,
                                                  const LuminanceWeights& weights) {
  const std::optional<double> correlation = noise_correlation(light, guides, weights);
  if (!correlation || *correlation < kCorrelated) return std::nullopt;
  if (*correlation > kSmoothed) {
    return fmt::format(
        "the light looks denoised already: its neighbors share {:.0f} % of their noise; denoise "
        "what "
        "came from the renderer",
        100.0 * *correlation);
  }
  return fmt::format(
      "correlated noise: neighbors share {:.0f} % of it, so blotches may stay; render with a box "
      "filter of one pixel, or importance sampling of the pixel filter",
      100.0 * *correlation);
}

std::optional<std::string> check_noisy_feature(const Planes<3>& feature, const Planes<3>& light,
                                               std::string_view name,
                                               const LuminanceWeights& weights) {
  const Extent extent = light[0].extent();
  EL_CHECK(feature[0].extent() == extent, "{} is {}x{}, the light {}x{}", name, feature[0].width(),
           feature[0].height(), extent.width, extent.height);
  const auto length = [&](int x, int y) {
    if (!all_finite(feature, x, y)) return std::nan("");
    const glm::dvec3 v(feature[0](x, y), feature[1](x, y), feature[2](x, y));
    return glm::length(v) < 1e18 ? glm::length(v) : std::nan("");
  };
  const auto lit = [&](int x, int y) { return finite_luminance(light, weights, x, y); };
  std::vector<double> ours = relative_noise(extent, length), theirs = relative_noise(extent, lit);
  if (ours.size() < kFewestSmooth || theirs.size() < kFewestSmooth) return std::nullopt;
  const double noise = median(ours), of_light = median(theirs);
  if (noise < kLeastNoise || noise <= of_light) return std::nullopt;
  return fmt::format(
      "{} is noisier than the light ({:.0f} % of its mean, the light {:.0f} %): edges will be "
      "lost; "
      "render more samples, or {} without depth of field and motion blur",
      name, 100.0 * noise, 100.0 * of_light, name);
}

bool is_cut(const RawGuides& now, const RawGuides& before, const Planes<2>& motion) {
  const Extent extent = now.extent();
  if (before.extent() != extent || extent.pixels() == 0) return true;
  std::vector<PixelVector> vectors;
  for_grid(extent, 0, [&](int x, int y) {
    glm::vec2 vector(0.0f);
    if (!motion[0].empty()) vector = {motion[0](x, y), motion[1](x, y)};
    if (!std::isfinite(vector.x) || !std::isfinite(vector.y)) return;
    vectors.push_back({x, y, glm::clamp(vector, -1e6f, 1e6f)});
  });
  const Mismatch mismatch = compare_along(now, before, vectors);
  return mismatch.pixels >= kFewestSmooth && mismatch.residual > kCut;
}

}  // namespace eigenlight
