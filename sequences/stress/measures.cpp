#include "sequences/stress/measures.h"

#include <bit>
#include <cmath>
#include <limits>

namespace eigenlight {
namespace {

constexpr int kRuns = 4, kPool = 3;

// Variance over the runs at one pixel.
double variance_at(const std::vector<std::vector<Planes<3>>>& runs, std::size_t frame,
                   std::size_t c, glm::ivec2 p) {
  double sum = 0.0, square = 0.0;
  for (const auto& run : runs) {
    const double value = static_cast<double>(run[frame][c](p.x, p.y));
    sum += value;
    square += value * value;
  }
  return std::max(square - sum * sum / kRuns, 0.0) / (kRuns - 1);
}

Plane<float> pooled(const Plane<double>& variance) {
  const Extent extent = variance.extent();
  Plane<float> noise(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      double sum = 0.0, count = 0.0;
      for (int j = std::max(y - kPool, 0); j <= std::min(y + kPool, extent.height - 1); ++j) {
        for (int i = std::max(x - kPool, 0); i <= std::min(x + kPool, extent.width - 1); ++i) {
          sum += variance(i, j);
          count += 1.0;
        }
      }
      noise(x, y) = static_cast<float>(std::sqrt(sum / count));
    }
  }
  return noise;
}

template <typename Visit>
void for_each_surface(const StressRun& run, Visit visit) {
  const Frame& frame = run.frame();
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      if (frame.surface.id(x, y) == 0) continue;
      for (int c = 0; c < 3; ++c) {
        visit(static_cast<double>(run.picture()[static_cast<std::size_t>(c)](x, y)),
              static_cast<double>(run.truth({x, y}, c)));
      }
    }
  }
}

}  // namespace

Planes<3> copy_of(const Planes<3>& planes) {
  return {planes[0].clone(), planes[1].clone(), planes[2].clone()};
}

NoiseMaps noise_maps(StressLog& log, const AnalyticOptions& options) {
  std::vector<std::vector<Planes<3>>> runs(kRuns);
  for (std::uint32_t r = 0; r < kRuns; ++r) {
    AnalyticOptions other = options;
    other.seed = hash_key(options.seed, 0x6e6f6973u, r);
    StressRun run(log, other);
    while (const Planes<3>* picture = run.step()) runs[r].push_back(copy_of(*picture));
  }
  NoiseMaps maps;
  for (std::size_t f = 0; f < runs[0].size(); ++f) {
    Planes<3> map;
    for (std::size_t c = 0; c < 3; ++c) {
      Plane<double> variance(options.extent);
      for (int y = 0; y < options.extent.height; ++y) {
        for (int x = 0; x < options.extent.width; ++x) {
          variance(x, y) = variance_at(runs, f, c, {x, y});
        }
      }
      map[c] = pooled(variance);
    }
    maps.push_back(std::move(map));
  }
  return maps;
}

double largest_deviation(const Planes<3>& a, const Planes<3>& b, const Planes<3>& noise,
                         const std::function<bool(int, int)>& counts) {
  double largest = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        if (!counts(x, y)) continue;
        const double off = std::abs(static_cast<double>(a[c](x, y)) - b[c](x, y)) / noise[c](x, y);
        if (!(off <= largest)) largest = off;
        if (std::isnan(off)) return off;
      }
    }
  }
  return largest;
}

double largest_relative(const Planes<3>& a, const Planes<3>& b) {
  double largest = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        const double wanted = static_cast<double>(b[c](x, y));
        const double off = std::abs(static_cast<double>(a[c](x, y)) - wanted) /
                           (wanted == 0.0 ? 1.0 : std::abs(wanted));
        if (std::isnan(off)) return off;
        largest = std::max(largest, off);
      }
    }
  }
  return largest;
}

double relative_error(const StressRun& run) {
  double sum = 0.0, count = 0.0;
  for_each_surface(run, [&](double value, double truth) {
    sum += (value / truth - 1.0) * (value / truth - 1.0);
    count += 1.0;
  });
  return sum / count;
}

double relative_bias(const StressRun& run) {
  double found = 0.0, wanted = 0.0;
  for_each_surface(run, [&](double value, double truth) {
    found += value;
    wanted += truth;
  });
  return found / wanted - 1.0;
}

double different_pixels(const Planes<3>& a, const Planes<3>& b) {
  double count = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
        count += bits(a[c](x, y)) != bits(b[c](x, y)) ? 1.0 : 0.0;
      }
    }
  }
  return count;
}

}  // namespace eigenlight
