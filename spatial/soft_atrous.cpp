#include "spatial/soft_atrous.h"

#include <cmath>

#include "frame/check.h"

namespace eigenlight {
namespace {

// Rows in an order in which those that are `step` apart follow each other: taps meet rows that are
// in the cache.
std::vector<int> rows_by_step(int height, int step) {
  std::vector<int> rows;
  for (int first = 0; first < step; ++first) {
    for (int y = first; y < height; y += step) rows.push_back(y);
  }
  return rows;
}

}  // namespace

void SoftAtrousOptions::validate() const {
  EL_CHECK(passes >= 1 && passes <= 6, "passes {}: expected 1 to 6", passes);
  EL_CHECK(radius == 1 || radius == 2, "radius {}: expected 1 or 2", radius);
}

SoftAtrous::SoftAtrous(Extent extent, const SoftAtrousOptions& options)
    : extent_(extent), options_(options) {
  options.validate();
  for (std::size_t i = 0; i < kSoftGuides; ++i) guides_.emplace_back(extent);
  for (int i = 0; i < 4; ++i) near_.emplace_back(extent);
}

void SoftAtrous::prepare(const Plane<PackedGuide>& guides) {
  EL_CHECK(guides.extent() == extent_, "guides of {}x{} pixels, expected {}x{}", guides.width(),
           guides.height(), extent_.width, extent_.height);
  const float scale = std::sqrt(0.125f) / kGuideSteps;
  parallel_for(extent_.height, [&](int y) {
    const PackedGuide* from = guides.row(y);
    for (std::size_t i = 0; i < 6; ++i) {
      float* to = guides_[i].row(y);
      for (int x = 0; x < extent_.width; ++x) {
        to[x] = scale * static_cast<float>(from[x].normal_color[i]);
      }
    }
    float* depth = guides_[6].row(y);
    for (int x = 0; x < extent_.width; ++x) {
      depth[x] =
          shows_surface(from[x]) ? scale * static_cast<float>(from[x].depth) : kNoSoftSurface;
    }
  });
  parallel_for(extent_.height, [&](int y) { soft_near_row(guides_, y, near_); });
}

std::vector<SoftWork> SoftAtrous::start(std::span<const SoftLayer> layers) {
  buffers_.resize(layers.size());
  std::vector<SoftWork> work;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    Buffers& b = buffers_[i];
    ensure_extent(b.light, extent_);
    for (Plane<float>* plane : {&b.variance, &b.mean, &b.tolerance, &b.usable, &b.luminance}) {
      ensure_extent(*plane, extent_);
    }
    const SoftLayer& layer = layers[i];
    work.push_back({layer.light, layer.variance, &b.usable, &b.luminance, &b.mean, &b.tolerance,
                    &b.light, &b.variance, layer.sigmas});
  }
  parallel_for(extent_.height, [&](int y) {
    for (const SoftWork& layer : work) soft_start_row(guides_, layer, y);
  });
  return work;
}

void SoftAtrous::process(const Plane<PackedGuide>& guides, std::span<const SoftLayer> layers) {
  prepare(guides);
  const std::vector<SoftWork> work = start(layers);
  for (int i = 0; i < options_.passes; ++i) {
    const SoftPass pass{guides_, near_, work, options_.radius, 1 << i, i == 0};
    parallel_for(extent_.height, [&](int y) { soft_means_row(pass, y); });
    const std::vector<int> rows = rows_by_step(extent_.height, pass.step);
    parallel_for(extent_.height,
                 [&](int row) { soft_filter_row(pass, rows[static_cast<std::size_t>(row)]); });
    for (const SoftWork& layer : work) {
      std::swap(*layer.light, *layer.out_light);
      std::swap(*layer.variance, *layer.out_variance);
    }
  }
}

void variance_of_frame(const FrameInput& frame, const Planes<3>& light, Plane<float>& variance) {
  ensure_extent(variance, frame.extent());
  parallel_for(variance.height(), [&](int y) { soft_variance_row(frame, light, y, variance); });
}

}  // namespace eigenlight
