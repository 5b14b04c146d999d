// EigenDenoiser in double, whole images instead of tiles and rows: what rounding does to the fast
// one shows against it.
#pragma once

#include "reproject/surface_history.h"
#include "temporal/change/edges.h"
#include "temporal/eigen/eigen_denoiser.h"
#include "tests/reference/guided_filter.h"
#include "tests/reference/pipeline/cells.h"
#include "tests/reference/pipeline/memory.h"

namespace eigenlight::twin {

/// A frame as the fast denoiser met it. Geometry, the samples that it was granted, and the births
/// and ends of its bases are inputs: they are decisions, which float and double may take
/// differently where a value meets a threshold. All that is light is computed here.
struct Given {
  const FrameInput& frame;
  bool cut;
  const Plane<std::uint8_t>& extra;  ///< samples granted
  const Planes<3>& extra_mean;       ///< their mean, where there are any
  int newborn;                       ///< slot, or 0
  std::vector<int> retired;          ///< slots
};

class EigenTwin {
 public:
  EigenTwin(Extent extent, int bases)
      : surfaces_(extent),
        bases_(extent),
        memory_(extent, bases),
        coefficients_(kMaxBases, TileValues(extent)),
        learning_rates_(coefficients_),
        r_(extent),
        new_age_(extent),
        picture_(extent),
        earlier_(extent) {}

  /// Red, green, blue (and variance) of the picture.
  const reference::AtrousImage& step(const Given& in) {
    warp(in);
    project(in.frame);
    merge_samples(in);
    predict();
    bound(options_.fireflies, r_);
    correct(options_.correction, in.frame, r_);
    memory_.learn(coefficients_, learning_rates_);
    test_innovation(in.frame);
    shorten_ages(in.frame);
    update(in.newborn);
    if (in.newborn > 0) memory_.born(in.newborn);
    for (const int k : in.retired) {
      memory_.retire(k);
      bases_[k] = make_light(bases_.age.extent);
    }
    filter(in.frame);
    surfaces_.keep(in.frame);
    return picture_;
  }

 private:
  void warp(const Given& in) {
    const Extent extent = bases_.age.extent;
    earlier_.each([&](int x, int y) { earlier_(x, y) = picture_.luminance(x, y); });
    if (in.cut) {
      bases_ = Bases(extent);
      r_.variance = Image(extent);
      memory_.reset();
    } else if (!in.frame.is_static) {
      move(in.frame);
    }
    r_.age = bases_.age;
  }

  void move(const FrameInput& frame) {
    Bases moved(bases_.age.extent);
    Image variance(bases_.age.extent), earlier(bases_.age.extent);
    TapSegment taps;
    bases_.age.each([&](int x, int y) {  // row by row, from left to right
      const auto at = static_cast<std::size_t>(x % kSegment);
      if (at == 0) {
        const int end = std::min(x + kSegment, frame.extent().width);
        compute_taps(frame, surfaces_.previous(), options_.taps, {x, y, end, y + 1}, taps);
      }
      for (std::size_t t = 0; t < 4; ++t) {
        const double w = static_cast<double>(taps.weight[t][at]);
        if (w == 0.0) continue;
        const glm::ivec2 tap = taps.tap(static_cast<int>(t), at);
        const int i = tap.x, j = tap.y;
        for (int k = 0; k < kMaxBases; ++k) {
          for (std::size_t c = 0; c < 3; ++c) moved[k][c](x, y) += w * bases_[k][c](i, j);
        }
        moved.age(x, y) += w * bases_.age(i, j);
        variance(x, y) += w * r_.variance(i, j);
        earlier(x, y) += w * earlier_(i, j);
      }
    });
    earlier_ = std::move(earlier);
    bases_ = std::move(moved);
    r_.variance = std::move(variance);
  }

  void merge_samples(const Given& in) {
    r_.samples.each([&](int x, int y) {
      const double regular = std::max(in.frame.spp, 1), extra = in.extra(x, y);
      double size = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = regular * static_cast<double>(in.frame.lights[0].radiance[c](x, y));
        if (extra > 0.0) sum += extra * static_cast<double>(in.extra_mean[c](x, y));
        r_.light[c](x, y) = sum / (regular + extra);
        size += std::abs(r_.light[c](x, y));
      }
      const bool usable =
          in.frame.surface.id(x, y) != 0 && size <= static_cast<double>(kLargestLight);
      r_.samples(x, y) = usable ? (regular + extra) / regular : 0.0;
    });
  }

  void project(const FrameInput& frame) {
    const TileGrid& grid = coefficients_[0].grid;
    const SumScene scene{bases_, frame, r_.variance, memory_.active()};
    std::vector<Sums> sums;
    for (int i = 0; i < grid.count(); ++i) sums.push_back(tile_sums(scene, grid.tile(i)));
    for (int i = 0; i < grid.count(); ++i) {
      const SmallVector delta =
          solve(window_sums(sums, grid, i), memory_.expected(i), options_.shrink.noise);
      for (int k = 0; k < kMaxBases; ++k) {
        coefficients_[static_cast<std::size_t>(k)][i] =
            (k == 0 ? 1.0 : 0.0) + (k < delta.size() ? delta[k] : 0.0);
      }
    }
  }

  void predict() {
    r_.value.each([&](int x, int y) {
      std::array<double, 3> off{};
      for (std::size_t c = 0; c < 3; ++c) {
        double& sum = r_.prediction[c](x, y);
        sum = 0.0;
        for (int k = 0; k < memory_.active(); ++k) {
          sum += coefficients_[static_cast<std::size_t>(k)].at(x, y) * bases_[k][c](x, y);
        }
        off[c] = r_.light[c](x, y) - sum;
      }
      const bool confirmed = r_.age(x, y) > 0.0 && r_.samples(x, y) > 0.0;
      r_.confirmed(x, y) = confirmed ? 1.0 : 0.0;
      r_.value(x, y) = confirmed ? 0.2126 * off[0] + 0.7152 * off[1] + 0.0722 * off[2] : 0.0;
      const double gain = coefficients_[0].at(x, y);
      const double beyond = gain > 2.0 ? gain / 2.0 : std::min(2.0 * gain, 1.0);
      r_.variance(x, y) = std::min(beyond * beyond * r_.variance(x, y), 1e36);
    });
  }

  // New ages, and variances of one frame.
  void test_innovation(const FrameInput& frame) {
    Image variance = r_.variance;
    new_age_.each([&](int x, int y) {
      const double n = r_.age(x, y), s = r_.samples(x, y);
      const double oldest = std::max(static_cast<double>(options_.innovation.max_age), s);
      new_age_(x, y) = std::min(n + s, oldest);
      if (frame.surface.id(x, y) != 0 && n == 0.0) variance(x, y) = fresh_variance(frame, {x, y});
      if (!(r_.confirmed(x, y) > 0.0)) return;
      double count = 0.0, sum = 0.0, v = 0.0;
      const auto each = [&](auto body) {
        r_.value.each_around({x, y}, 4, [&](int i, int j) {
          if (r_.confirmed(i, j) > 0.0) body(r_.value(i, j));
        });
      };
      each([&](double e) { count += 1.0, sum += e; });
      if (count < 2.0) return;
      const double mu = sum / count;
      each([&](double e) { v += (e - mu) * (e - mu) / count; });
      const double chance = options_.innovation.threshold * v / count * (1.0 + 1.0 / n);
      const double history = v / n + std::max(0.0, mu * mu - chance), total = history + v / s;
      const double w = total > 0.0 ? history / total : s / (n + s);
      new_age_(x, y) = std::min(s / w, oldest);
      variance(x, y) += (v - variance(x, y)) / std::min(new_age_(x, y) / s, 16.0);
    });
    r_.variance = std::move(variance);
  }

  void shorten_ages(const FrameInput& frame) {
    const Plane<std::uint8_t> edges = find_edges(frame);
    const double most = static_cast<double>(options_.innovation.max_age);
    const double least = std::min(static_cast<double>(options_.max_age_changing), most);
    new_age_.each([&](int x, int y) {
      const int columns = r_.change.grid.columns();
      const double change = r_.change[y / kCoefficientTile * columns + x / kCoefficientTile];
      const double longest = 1.0 / ((1.0 - change) / most + change / least);
      const double edge = std::min(static_cast<double>(options_.max_age_edge), longest * 2.0 / 3.0);
      if (edges(x, y) != 0 || change > 0.0) {
        const double bound = edges(x, y) != 0 ? edge : longest;
        new_age_(x, y) = std::min(new_age_(x, y), std::max(bound, r_.samples(x, y)));
      }
    });
  }

  // By the fast kernel: where an edge is, geometry decides.
  [[nodiscard]] Plane<std::uint8_t> find_edges(const FrameInput& frame) const {
    Plane<std::uint8_t> edges(new_age_.extent);
    const TileGrid grid = stage_tiles(new_age_.extent);
    for (int i = 0; i < grid.count() && !frame.is_static; ++i) {
      eigenlight::find_edges(frame, options_.taps, grid.tile(i), edges);
    }
    return edges;
  }

  [[nodiscard]] double fresh_variance(const FrameInput& frame, glm::ivec2 p) const {
    double count = 0.0, sum = 0.0, square = 0.0;
    r_.samples.each_around(p, 3, [&](int x, int y) {
      if (!(r_.samples(x, y) > 0.0)) return;
      const auto& u = frame.lights[0].radiance;
      const double most = r_.brightness(x / 8, y / 8);
      const double l =
          std::clamp(0.2126 * u[0](x, y) + 0.7152 * u[1](x, y) + 0.0722 * u[2](x, y), -most, most);
      count += 1.0, sum += l, square += l * l;
    });
    return count > 1.0 ? std::max(square / count - sum * sum / (count * count), 0.0) : 0.0;
  }

  void update(int newborn) {
    const int active = memory_.active();
    bases_.age.each([&](int x, int y) {
      const bool known = r_.age(x, y) > 0.0, usable = r_.samples(x, y) > 0.0;
      const double s = r_.samples(x, y), n = known ? std::max(new_age_(x, y) - s, 0.0) : 0.0;
      std::array<double, kMaxBases> c{}, q{};
      double h = 0.0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(active); ++k) {
        c[k] = k == 0 ? 1.0 : coefficients_[k].at(x, y);
        q[k] = learning_rates_[k].at(x, y);
        h += c[k] * q[k];
      }
      h = std::max(h, 1.0);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double off = r_.light[channel](x, y) - r_.prediction[channel](x, y);
        const double correction = known ? r_.correction[channel](x, y) : 0.0;
        const double learned =
            (newborn == 0 ? correction / h : 0.0) + (usable ? off * s / (n + h * s) : 0.0);
        double& shown = picture_.values[channel][picture_.index(x, y)];
        shown = 0.0;
        for (int k = 0; k < active; ++k) {
          double& v = bases_[k][channel](x, y);
          v = (known ? v : 0.0) * (k == 0 ? coefficients_[0].at(x, y) : 1.0) +
              q[static_cast<std::size_t>(k)] * learned;
          shown += c[static_cast<std::size_t>(k)] * v;
        }
        if (newborn == 0) continue;
        bases_[newborn][channel](x, y) = correction;
        shown += correction;
      }
      bases_.age(x, y) = known || usable ? new_age_(x, y) : 0.0;
    });
  }

  void filter(const FrameInput& frame) {
    const Extent extent = new_age_.extent;
    Plane<std::uint8_t> young(extent);
    Light shown = make_light(extent);
    new_age_.each([&](int x, int y) {
      const double n = new_age_(x, y);
      const std::size_t at = picture_.index(x, y);
      picture_.values[3][at] = n > 0.0 ? r_.variance(x, y) / n : 0.0;
      for (std::size_t c = 0; c < 3; ++c) shown[c](x, y) = picture_.values[c][at];
      young(x, y) = frame.surface.id(x, y) != 0 && n < options_.young_age ? 1 : 0;
    });
    // The guided filter's twin takes planes of float: nothing of it comes back to the history.
    const Planes<3> signal = rounded(shown);
    const Plane<float> weight = rounded(new_age_);
    const Planes<3> guided =
        reference::guided_filter({frame, signal, weight, young}, options_.guided);
    young_pixels(frame, young, guided);
    earlier_.each([&](int x, int y) {
      if (!(r_.age(x, y) > 0.0)) earlier_(x, y) = std::numeric_limits<double>::quiet_NaN();
    });
    for (int pass = 0; pass < options_.atrous.passes; ++pass) {
      const reference::AtrousImage before = picture_;
      picture_ = reference::atrous_pass(frame, options_.atrous, before, 1 << pass, earlier_.values);
      keep_quiet_tiles(before);
    }
  }

  void young_pixels(const FrameInput& frame, const Plane<std::uint8_t>& young,
                    const Planes<3>& guided) {
    new_age_.each([&](int x, int y) {
      if (young(x, y) == 0 || std::isinf(frame.surface.depth(x, y))) return;
      const double own = new_age_(x, y) / options_.young_age;
      const std::size_t at = picture_.index(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        const double smooth = std::max(static_cast<double>(guided[c](x, y)), 0.0);
        picture_.values[c][at] = smooth + own * (picture_.values[c][at] - smooth);
      }
      picture_.values[3][at] *= own * own;
    });
  }

  void keep_quiet_tiles(const reference::AtrousImage& before) {
    const TileGrid grid = stage_tiles(before.extent);
    for (int i = 0; i < grid.count(); ++i) {
      const Tile tile = grid.tile(i);
      bool quiet = true;
      const auto each = [&](auto body) {
        for (int y = tile.y0; y < tile.y1; ++y) {
          for (int x = tile.x0; x < tile.x1; ++x) body(before.index(x, y), before.luminance(x, y));
        }
      };
      each([&](std::size_t at, double l) {
        quiet = quiet && !(before.values[3][at] > options_.quiet_variance * l * l);
      });
      if (!quiet) continue;
      each([&](std::size_t at, double) {
        for (std::size_t c = 0; c < 4; ++c) picture_.values[c][at] = before.values[c][at];
      });
    }
  }

  EigenOptions options_;
  SurfaceHistory surfaces_;
  Bases bases_;
  Memory memory_;
  TileVectors coefficients_, learning_rates_;  // c and q
  Residual r_;
  Image new_age_;
  reference::AtrousImage picture_;
  Image earlier_;  // luminance of the last picture, brought here
};

}  // namespace eigenlight::twin
