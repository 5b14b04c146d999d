#include "spatial/soft_atrous.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "frame/check.h"
#include "frame/luminance.h"

namespace eigenlight {
namespace {

constexpr std::array<float, 3> kBinomial{0.25f, 0.5f, 0.25f};
constexpr std::array<float, 5> kSpline{1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};
constexpr std::size_t kGuides = 7;

// A neighbor's offset and what it shares with all layers.
struct Tap {
  int dx, dy;
  float kernel;
};

std::vector<Tap> taps_of(int radius, int step) {
  std::vector<Tap> taps;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const auto at = [&](int d) {
        const auto i = static_cast<std::size_t>(d + radius);
        return radius == 1 ? kBinomial[i] : kSpline[i];
      };
      if (dx != 0 || dy != 0) taps.push_back({dx * step, dy * step, at(dx) * at(dy)});
    }
  }
  return taps;
}

float center_of(int radius) {
  return radius == 1 ? kBinomial[1] * kBinomial[1] : kSpline[2] * kSpline[2];
}

// A neighbor among 3 x 3 pixels and where the weight of geometry between both is kept.
struct Near {
  int dx, dy, plane;
  bool is_there;  // at the neighbor
};
constexpr std::array<Near, 8> kNeighbors{{{1, 0, 0, false},
                                          {-1, 1, 1, false},
                                          {0, 1, 2, false},
                                          {1, 1, 3, false},
                                          {-1, 0, 0, true},
                                          {1, -1, 1, true},
                                          {0, -1, 2, true},
                                          {-1, -1, 3, true}}};

// Pixels of a row whose neighbor lies in the image.
struct Span {
  int x0, x1;
};
Span inside(int width, int dx) { return {std::max(0, -dx), std::min(width, width - dx)}; }

// Weights of geometry of the pixels [x0, x1) of a row against those dx, dy away.
void geometry(const std::vector<Plane<float>>& guides, const Plane<float>& surface, int y, int dx,
              int dy, Span span, float* weight) {
  std::array<const float*, kGuides> here{}, there{};
  for (std::size_t i = 0; i < kGuides; ++i) {
    here[i] = guides[i].row(y);
    there[i] = guides[i].row(y + dy) + dx;
  }
  const float* shows = surface.row(y + dy) + dx;
  for (int x = span.x0; x < span.x1; ++x) {
    float square = 0.0f;
    for (std::size_t i = 0; i < kGuides; ++i) {
      const float d = here[i][x] - there[i][x];
      square += d * d;
    }
    weight[x] = falloff(square) * shows[x];
  }
}

}  // namespace

void SoftAtrousOptions::validate() const {
  EL_CHECK(passes >= 1 && passes <= 6, "passes {}: expected 1 to 6", passes);
  EL_CHECK(radius == 1 || radius == 2, "radius {}: expected 1 or 2", radius);
}

SoftAtrous::SoftAtrous(Extent extent, const SoftAtrousOptions& options)
    : extent_(extent), options_(options), surface_(extent), geometry_(extent) {
  options.validate();
  for (std::size_t i = 0; i < kGuides; ++i) guides_.emplace_back(extent);
  for (int i = 0; i < 4; ++i) near_.emplace_back(extent);
}

void SoftAtrous::prepare(const Plane<PackedGuide>& guides) {
  EL_CHECK(guides.extent() == extent_, "guides of {}x{} pixels, expected {}x{}", guides.width(),
           guides.height(), extent_.width, extent_.height);
  parallel_for(extent_.height, [&](int y) {
    for (int x = 0; x < extent_.width; ++x) {
      const PackedGuide& guide = guides(x, y);
      surface_(x, y) = shows_surface(guide) ? 1.0f : 0.0f;
      for (std::size_t i = 0; i < 6; ++i) {
        guides_[i](x, y) = static_cast<float>(guide.normal_color[i]) / kGuideSteps;
      }
      guides_[6](x, y) = static_cast<float>(guide.depth) / kGuideSteps;
    }
  });
  find_near();
}

void SoftAtrous::find_near() {
  parallel_for(extent_.height, [&](int y) {
    constexpr std::array<std::array<int, 2>, 4> kNear{{{1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
    for (std::size_t i = 0; i < 4; ++i) {
      float* weight = near_[i].row(y);
      std::fill_n(weight, extent_.width, 0.0f);
      const int dx = kNear[i][0], dy = kNear[i][1];
      if (y + dy >= extent_.height) continue;
      const Span span = inside(extent_.width, dx);
      geometry(guides_, surface_, y, dx, dy, span, weight);
      for (int x = span.x0; x < span.x1; ++x) weight[x] *= surface_(x, y);
    }
  });
}

void SoftAtrous::exclude_bad(std::span<const SoftLayer> layers) {
  buffers_.resize(layers.size());
  for (std::size_t i = 0; i < layers.size(); ++i) {
    Buffers& buffer = buffers_[i];
    ensure_extent(buffer.light, extent_);
    for (Plane<float>* plane :
         {&buffer.variance, &buffer.mean, &buffer.tolerance, &buffer.usable, &buffer.sum}) {
      ensure_extent(*plane, extent_);
    }
    parallel_for(extent_.height, [&](int y) {
      for (int x = 0; x < extent_.width; ++x) {
        Planes<3>& light = *layers[i].light;
        float& variance = (*layers[i].variance)(x, y);
        const bool is_good = std::isfinite(light[0](x, y) + light[1](x, y) + light[2](x, y)) &&
                             std::isfinite(variance) && surface_(x, y) != 0.0f;
        buffer.usable(x, y) = is_good ? 1.0f : 0.0f;
        if (is_good) continue;
        for (auto& plane : light) plane(x, y) = 0.0f;
        variance = 0.0f;
      }
    });
  }
}

// Means of luminance over 3 x 3 pixels of the same surface, and what counts as the same light.
void SoftAtrous::find_means(const SoftLayer& layer, Buffers& buffer, int y) const {
  for (int x = 0; x < extent_.width; ++x) {
    float sum = 0.25f * buffer.usable(x, y), squares = sum * sum;
    float mean = sum * luminance(*layer.light, x, y), spread = sum * (*layer.variance)(x, y);
    for (const Near& near : kNeighbors) {
      const int qx = x + near.dx, qy = y + near.dy;
      if (!extent_.contains(qx, qy)) continue;
      const Plane<float>& plane = near_[static_cast<std::size_t>(near.plane)];
      const float kernel = near.dx != 0 && near.dy != 0 ? 0.0625f : 0.125f;
      const float weight =
          kernel * (near.is_there ? plane(qx, qy) : plane(x, y)) * buffer.usable(qx, qy);
      sum += weight;
      squares += weight * weight;
      mean += weight * luminance(*layer.light, qx, qy);
      spread += weight * (*layer.variance)(qx, qy);
    }
    const float over = sum > 0.0f ? 1.0f / sum : 0.0f;
    buffer.mean(x, y) = mean * over;
    const float deviation = std::sqrt(std::max(spread * over * squares * over * over, 0.0f));
    buffer.tolerance(x, y) = layer.sigmas * deviation + 1e-4f * std::abs(mean * over) + 1e-6f;
  }
}

// The pixels' own share.
void SoftAtrous::start_row(const SoftLayer& layer, Buffers& out, int y) const {
  const float center = center_of(options_.radius);
  for (int x = 0; x < extent_.width; ++x) {
    const float own = center * out.usable(x, y);
    for (std::size_t c = 0; c < 3; ++c) out.light[c](x, y) = own * (*layer.light)[c](x, y);
    out.variance(x, y) = own * own * (*layer.variance)(x, y);
    out.sum(x, y) = own;
  }
}

void SoftAtrous::add_tap(const SoftLayer& layer, const TapRow& tap, Buffers& out) const {
  const int y = tap.y, q = tap.y + tap.dy;
  const float *mean = out.mean.row(y), *other = out.mean.row(q) + tap.dx;
  const float *tolerance = out.tolerance.row(y), *others = out.tolerance.row(q) + tap.dx;
  const float* usable = out.usable.row(q) + tap.dx;
  const float* variance = layer.variance->row(q) + tap.dx;
  const Planes<3>& in = *layer.light;
  const float *r = in[0].row(q) + tap.dx, *g = in[1].row(q) + tap.dx, *b = in[2].row(q) + tap.dx;
  float *to_r = out.light[0].row(y), *to_g = out.light[1].row(y), *to_b = out.light[2].row(y);
  float *to_variance = out.variance.row(y), *sum = out.sum.row(y);
  for (int x = tap.x0; x < tap.x1; ++x) {
    const float w = tap.kernel * tap.geometry[x] * usable[x] *
                    falloff(std::abs(mean[x] - other[x]) * 2.0f / (tolerance[x] + others[x]));
    sum[x] += w;
    to_r[x] += w * r[x];
    to_g[x] += w * g[x];
    to_b[x] += w * b[x];
    to_variance[x] += w * w * variance[x];
  }
}

void SoftAtrous::finish_row(Buffers& out, int y) const {
  for (int x = 0; x < extent_.width; ++x) {
    const float sum = out.sum(x, y);
    const float over = sum > 0.0f ? surface_(x, y) / sum : 0.0f;
    for (auto& plane : out.light) plane(x, y) *= over;
    out.variance(x, y) *= over * over;
  }
}

void SoftAtrous::filter_row(std::span<const SoftLayer> layers, int pass, int y) {
  float* weight = geometry_.row(y);
  for (std::size_t i = 0; i < layers.size(); ++i) start_row(layers[i], buffers_[i], y);
  for (const Tap& tap : taps_of(options_.radius, 1 << pass)) {
    if (y + tap.dy < 0 || y + tap.dy >= extent_.height) continue;
    const Span span = inside(extent_.width, tap.dx);
    geometry(guides_, surface_, y, tap.dx, tap.dy, span, weight);
    const TapRow row{y, tap.dx, tap.dy, span.x0, span.x1, tap.kernel, weight};
    for (std::size_t i = 0; i < layers.size(); ++i) add_tap(layers[i], row, buffers_[i]);
  }
  for (std::size_t i = 0; i < layers.size(); ++i) finish_row(buffers_[i], y);
}

void SoftAtrous::process(const Plane<PackedGuide>& guides, std::span<const SoftLayer> layers) {
  prepare(guides);
  exclude_bad(layers);
  for (int pass = 0; pass < options_.passes; ++pass) {
    parallel_for(extent_.height, [&](int y) {
      for (std::size_t i = 0; i < layers.size(); ++i) find_means(layers[i], buffers_[i], y);
    });
    parallel_for(extent_.height, [&](int y) { filter_row(layers, pass, y); });
    for (std::size_t i = 0; i < layers.size(); ++i) {
      std::swap(*layers[i].light, buffers_[i].light);
      std::swap(*layers[i].variance, buffers_[i].variance);
      // What was excluded has the value of its neighbors now.
      if (pass == 0) buffers_[i].usable.copy_from(surface_);
    }
  }
}

void variance_of_frame(const FrameInput& frame, const Planes<3>& light, Plane<float>& variance) {
  const Extent extent = frame.extent();
  ensure_extent(variance, extent);
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      double count = 0.0, sum = 0.0, squares = 0.0;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          if (!extent.contains(x + dx, y + dy) || frame.surface.id(x + dx, y + dy) == 0) continue;
          const double l = static_cast<double>(luminance(light, x + dx, y + dy));
          if (!std::isfinite(l)) continue;
          count += 1.0, sum += l, squares += l * l;
        }
      }
      const double mean = count > 0.0 ? sum / count : 0.0;
      variance(x, y) =
          count > 1.0 ? static_cast<float>(std::max(squares / count - mean * mean, 0.0)) : 0.0f;
    }
  });
}

}  // namespace eigenlight
