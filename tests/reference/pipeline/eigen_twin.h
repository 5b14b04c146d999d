// EigenDenoiser in double, on whole images instead of tiles and rows, to show what rounding does.
// Its stages are the twins that the tests of kernels use.
#pragma once

#include "reproject/surface_history.h"
#include "temporal/change/edges.h"
#include "temporal/eigen/eigen_denoiser.h"
#include "tests/reference/edges.h"
#include "tests/reference/guided_filter.h"
#include "tests/reference/innovation.h"
#include "tests/reference/pipeline/correction.h"
#include "tests/reference/pipeline/inputs.h"
#include "tests/reference/pipeline/memory.h"
#include "tests/reference/predict.h"
#include "tests/reference/signal.h"
#include "tests/reference/update.h"
#include "tests/reference/warp.h"

namespace eigenlight::twin {

/// A frame of the fast denoiser. Geometry, granted samples, and births and ends of bases are
/// inputs, because float and double may decide differently where a value is near a threshold. All
/// light is computed here.
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
        bases_(extent, bases),
        memory_(extent, bases),
        coefficients_(extent),
        learning_rates_(extent),
        light_(reference::make_light(extent)),
        r_(extent),
        new_age_(extent),
        picture_(extent),
        earlier_(extent) {}

  /// Red, green, blue (and variance) of the picture.
  const reference::AtrousImage& step(const Given& in) {
    warp(in);
    merge_samples(in);
    project(in.frame);
    predict();
    reference::bound_fireflies(options_.fireflies, r_);
    correct(options_.correction, in.frame, r_);
    memory_.learn(coefficients_, learning_rates_);
    test_innovation(in.frame);
    shorten_ages(in.frame);
    update(in.newborn);
    if (in.newborn > 0) memory_.born(in.newborn);
    for (const int k : in.retired) {
      memory_.retire(k);
      bases_.clear_basis(k);
    }
    filter(in.frame);
    surfaces_.keep(in.frame);
    return picture_;
  }

 private:
  void warp(const Given& in) {
    const Extent extent = bases_.age.extent();
    earlier_.each([&](int x, int y) { earlier_(x, y) = picture_.luminance(x, y); });
    if (in.cut) {
      bases_ = Bases(extent, bases_.bases());
      r_.variance = Image(extent);
      memory_.reset();
    } else if (!in.frame.is_static) {
      move(in.frame);
    }
    r_.age = bases_.age;
  }

  void move(const FrameInput& frame) {
    const Extent extent = bases_.age.extent();
    Bases moved(extent, bases_.bases());
    Image variance(extent), earlier(extent);
    TapSegment taps;
    bases_.age.each([&](int x, int y) {  // row by row, from left to right
      const int at = x % kSegment;
      if (at == 0) {
        const int end = std::min(x + kSegment, extent.width);
        compute_taps(frame, surfaces_.previous(), options_.taps, {x, y, end, y + 1}, taps);
      }
      for (int k = 0; k < bases_.bases(); ++k) {
        for (int c = 0; c < 3; ++c) {
          moved.value(x, y, c, k) = reference::warped(
              taps, at, [&](int i, int j) { return std::as_const(bases_).value(i, j, c, k); });
        }
      }
      moved.age(x, y) = reference::warped(taps, at, std::as_const(bases_.age));
      variance(x, y) = reference::warped(taps, at, std::as_const(r_.variance));
      earlier(x, y) = reference::warped(taps, at, std::as_const(earlier_));
    });
    earlier_ = std::move(earlier);
    bases_ = std::move(moved);
    r_.variance = std::move(variance);
  }

  void merge_samples(const Given& in) {
    const Plane<float> age;  // only counts of new pixels depend on it
    r_.samples.each([&](int x, int y) {
      const auto merged = reference::merged_samples(
          {in.frame, in.frame.lights[0].radiance, &in.extra, &in.extra_mean, age}, x, y);
      r_.samples(x, y) = merged.samples;
      for (std::size_t c = 0; c < 3; ++c) light_[c](x, y) = merged.light[c];
    });
  }

  void project(const FrameInput& frame) {
    const TileGrid& grid = coefficients_.grid();
    const Sums in{bases_, frame.lights[0].radiance, r_.variance, memory_.active()};
    std::vector<TileSums> sums;
    for (int i = 0; i < grid.count(); ++i) {
      sums.push_back(reference::tile_sums(in, grid.tile(i)));
    }
    for (int i = 0; i < grid.count(); ++i) {
      const auto delta =
          reference::coefficients(reference::window(sums, grid, i),
                                  {options_.shrink, memory_.expected(i)}, memory_.active());
      coefficients_.tile(i).fill(0.0);
      std::copy(delta.begin(), delta.end(), coefficients_.tile(i).begin());
    }
  }

  void predict() {
    r_.innovation.each([&](int x, int y) {
      const auto twin = reference::predict(bases_, coefficients_, light_, x, y);
      for (std::size_t c = 0; c < 3; ++c) r_.residual[c](x, y) = twin.residual[c];
      r_.innovation(x, y) = twin.innovation;
      r_.expected(x, y) = twin.expected;
      r_.variance(x, y) = std::min(twin.variance_factor * r_.variance(x, y), 1e36);
    });
  }

  // New ages, and variances of one frame.
  void test_innovation(const FrameInput& frame) {
    const Innovations in{r_.innovation, r_.age, r_.samples};
    Image variance = r_.variance;
    new_age_.each([&](int x, int y) {
      const auto twin = reference::innovation(in, options_.innovation, {x, y}, variance(x, y));
      new_age_(x, y) = twin.age;
      variance(x, y) = twin.variance;
      if (frame.surface.id(x, y) == 0 || r_.age(x, y) > 0.0) return;
      variance(x, y) =
          reference::fresh_variance(frame.lights[0].radiance, r_.samples, r_.brightness, {x, y});
    });
    r_.variance = std::move(variance);
  }

  void shorten_ages(const FrameInput& frame) {
    const Plane<std::uint8_t> edges = find_edges(frame);
    const double most = static_cast<double>(options_.innovation.max_age);
    const double least = std::min(static_cast<double>(options_.max_age_changing), most);
    const TileGrid& grid = coefficients_.grid();
    new_age_.each([&](int x, int y) {
      const int tile = y / kCoefficientTile * grid.columns() + x / kCoefficientTile;
      const double change = r_.change[tile];
      const double inside = 1.0 / ((1.0 - change) / most + change / least);
      const double at_edges =
          std::min(static_cast<double>(options_.max_age_edge), inside * 2.0 / 3.0);
      const bool is_edge = edges(x, y) != 0;
      if (!is_edge && change == 0.0) return;
      new_age_(x, y) =
          reference::shortened_age(new_age_(x, y), r_.samples(x, y), is_edge ? at_edges : inside);
    });
  }

  // By the fast kernel, because edges depend on geometry only.
  [[nodiscard]] Plane<std::uint8_t> find_edges(const FrameInput& frame) const {
    Plane<std::uint8_t> edges(new_age_.extent());
    const TileGrid grid = stage_tiles(new_age_.extent());
    for (int i = 0; i < grid.count() && !frame.is_static; ++i) {
      eigenlight::find_edges(frame, options_.taps, grid.tile(i), edges);
    }
    return edges;
  }

  void update(int newborn) {
    const Updates in{coefficients_, learning_rates_, r_.residual,      &r_.correction, r_.samples,
                     r_.age,        new_age_,        memory_.active(), newborn};
    bases_.age.each([&](int x, int y) {
      const reference::Updated twin = reference::update(in, std::as_const(bases_), {x, y});
      bases_.age(x, y) = twin.age;
      for (std::size_t c = 0; c < 3; ++c) {
        picture_.values[c][picture_.index(x, y)] = twin.estimate[c];
        for (int k = 0; k < bases_.bases(); ++k) {
          bases_.value(x, y, static_cast<int>(c), k) = twin.basis[c][static_cast<std::size_t>(k)];
        }
      }
    });
  }

  void filter(const FrameInput& frame) {
    const Extent extent = new_age_.extent();
    Plane<std::uint8_t> young(extent);
    Light shown = reference::make_light(extent);
    new_age_.each([&](int x, int y) {
      const double n = new_age_(x, y);
      const std::size_t at = picture_.index(x, y);
      picture_.values[3][at] = n > 0.0 ? r_.variance(x, y) / n : 0.0;
      for (std::size_t c = 0; c < 3; ++c) shown[c](x, y) = picture_.values[c][at];
      young(x, y) = frame.surface.id(x, y) != 0 && n < options_.young_age ? 1 : 0;
    });
    // The twin of the guided filter takes planes of float. Its result never enters the history.
    const Planes<3> signal = reference::rounded(shown);
    const Plane<float> weight = reference::rounded(new_age_);
    const Planes<3> guided =
        reference::guided_filter({frame, signal, weight, young}, options_.guided);
    young_pixels(frame, young, guided);
    earlier_.each([&](int x, int y) {
      if (!(r_.age(x, y) > 0.0)) earlier_(x, y) = std::numeric_limits<double>::quiet_NaN();
    });
    for (int pass = 0; pass < options_.atrous.passes; ++pass) {
      const reference::AtrousImage before = picture_;
      picture_ =
          reference::atrous_pass(frame, options_.atrous, before, 1 << pass, earlier_.values());
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
  Coefficients coefficients_, learning_rates_;  // c and q
  Light light_;                                 // this frame's samples; NaN: not usable
  Residual r_;
  Image new_age_;
  reference::AtrousImage picture_;
  Image earlier_;  // luminance of the last picture, warped to this frame
};

}  // namespace eigenlight::twin
