#include "sequences/conventions/depth_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "frame/check.h"
#include "frame/tiles.h"
#include "sequences/conventions/background.h"
#include "sequences/conventions/normal_reading.h"
#include "sequences/conventions/sampling.h"

namespace eigenlight {
namespace {

// Least ratio of the worse residual to the better one.
constexpr double kClear = 1.5;
constexpr double kSampled = 20000;
// A unit of its own is believed beyond that: rounding to half's 11 bits is far below.
constexpr double kUnit = 0.01;

// The file's depth over that of the position, for both readings.
struct Ratios {
  std::vector<double> axis, ray;
};

void add_ratios(const RawGuides& frame, Ratios& ratios) {
  const Extent extent = frame.extent();
  const int step = grid_step(extent, kSampled);
  for (int y = step / 2; y < extent.height; y += step) {
    for (int x = step / 2; x < extent.width; x += step) {
      const float depth = frame.depth(x, y);
      const glm::vec3 world(frame.position[0](x, y), frame.position[1](x, y),
                            frame.position[2](x, y));
      const bool known = std::isfinite(world.x) && std::isfinite(world.y) && std::isfinite(world.z);
      if (is_background(depth) || !known) continue;
      const glm::vec3 view = frame.camera->to_view(world);
      if (!(view.z > 0.0f)) continue;
      ratios.axis.push_back(depth / view.z);
      ratios.ray.push_back(depth / glm::length(view));
    }
  }
}

struct UnitFit {
  double scale = 1.0, residual = 0.0;
};

// The unit of depths, and how far they are from it.
UnitFit fit_unit(std::vector<double> ratios) {
  UnitFit fit;
  const double ratio = median(ratios);
  if (ratio > 0.0 && std::abs(ratio - 1.0) > kUnit) fit.scale = 1.0 / ratio;
  for (double& value : ratios) value = std::abs(value * fit.scale - 1.0);
  fit.residual = median(ratios);
  return fit;
}

// Nearly the same for both: seen through a very long lens.
bool differ(double a, double b) { return std::max(a, b) > kClear * std::min(a, b); }

bool by_positions(std::span<const RawGuides> frames, DepthFit& fit) {
  Ratios ratios;
  for (const RawGuides& frame : frames) {
    if (frame.depth.empty() || frame.position[0].empty() || !frame.camera) continue;
    add_ratios(frame, ratios);
  }
  if (ratios.axis.size() < 64) return false;
  const UnitFit axis = fit_unit(ratios.axis), ray = fit_unit(ratios.ray);
  fit.axis_residual = axis.residual;
  fit.ray_residual = ray.residual;
  fit.is_clear = differ(axis.residual, ray.residual);
  fit.reading.along_ray = fit.is_clear && ray.residual < axis.residual;
  fit.reading.scale = fit.reading.along_ray ? ray.scale : axis.scale;
  const std::string unit =
      fit.reading.scale == 1.0
          ? std::string()
          : fmt::format(", times {:.4g} in the unit of positions", fit.reading.scale);
  fit.words = fmt::format("depth is along the {}{}: {:.2g} from positions, along the {} {:.2g}",
                          fit.reading.along_ray ? "ray" : "view axis", unit,
                          fit.reading.along_ray ? ray.residual : axis.residual,
                          fit.reading.along_ray ? "view axis" : "ray",
                          fit.reading.along_ray ? axis.residual : ray.residual);
  return true;
}

void by_normals(std::span<const RawGuides> frames, DepthFit& fit) {
  const NormalFit axis = find_normal(frames, {false, 1.0}), ray = find_normal(frames, {true, 1.0});
  fit.axis_residual = axis.residual;
  fit.ray_residual = ray.residual;
  if (!axis.is_clear && !ray.is_clear) {
    fit.words =
        "depth is taken to be along the view axis: the files hold no camera with positions or "
        "normals to compare it with";
    return;
  }
  fit.is_clear = differ(axis.residual, ray.residual);
  fit.reading.along_ray = fit.is_clear && ray.residual < axis.residual;
  fit.words = fmt::format(
      "depth is along the {}: its slope is {:.2g} degrees from normals, along the "
      "{} {:.2g}",
      fit.reading.along_ray ? "ray" : "view axis", std::min(axis.residual, ray.residual),
      fit.reading.along_ray ? "view axis" : "ray", std::max(axis.residual, ray.residual));
}

}  // namespace

DepthFit find_depth(std::span<const RawGuides> frames) {
  DepthFit fit;
  if (!by_positions(frames, fit)) by_normals(frames, fit);
  if (!fit.is_clear && fit.words.empty()) fit.words = "depth is taken to be along the view axis";
  return fit;
}

void apply_depth(const Plane<float>& raw, const DepthReading& reading, const Camera* camera,
                 Plane<float>& depth) {
  EL_CHECK(!reading.along_ray || camera != nullptr,
           "depth: along the ray it needs a camera; none was found");
  ensure_extent(depth, raw.extent());
  const auto scale = static_cast<float>(reading.scale);
  for_each_tile(stage_tiles(raw.extent()), [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        float value = raw(x, y);
        if (is_background(value)) {
          depth(x, y) = std::numeric_limits<float>::infinity();
          continue;
        }
        value *= scale;
        if (reading.along_ray) {
          const glm::vec2 pixel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          value /= glm::length(camera->pixel_to_view(pixel));
        }
        depth(x, y) = value;
      }
    }
  });
}

}  // namespace eigenlight
