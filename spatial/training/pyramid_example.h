// One image to learn the pyramid's weights from: the filter as a function of its weights, with the
// gradient by them.
#pragma once

#include <array>
#include <vector>

#include "spatial/rivals/pyramid.h"
#include "spatial/training/bilateral.h"
#include "spatial/training/structural_loss.h"

namespace eigenlight {

/// d loss / d weight of one pass.
struct PassGradient {
  std::array<double, 9> fine{}, coarse{};
  double gamma = 0.0;
};

/// What does not depend on weights: I_down, energies, and the brute-force result. Each is computed
/// once; a pass over the weights then is cheap.
class PyramidExample {
 public:
  /// Filters `in` by brute force, and takes the levels that edge.blur_radius needs. Values of the
  /// signal are expected around [0, 1].
  template <typename Edge>
  PyramidExample(const Edge& edge, const PyramidInputs& in) {
    const Extent extent = in.weight.extent();
    const int passes = pyramid_passes(edge.blur_radius);
    std::vector<PyramidLevel> levels = make_pyramid_levels(extent, Edge::kAttributes, passes);
    levels[0].attributes.copy_from(in.attributes);
    load_pyramid_values(in.signal, in.weight, {0, 0, extent.width, extent.height},
                        levels[0].values);
    float area = 1.0f;
    for (std::size_t l = 0; l + 1 < levels.size(); ++l, area *= 4.0f) {
      downsample_pyramid(edge, levels[l], area, levels[l + 1]);
    }
    target_ = make_planes<3>(extent);
    bilateral_filter(edge, in, target_);
    for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
      add_pass(levels[l].values);
      const int pixels = 1 << (2 * static_cast<int>(l));
      for_each_pixel(levels[l].values.extent(), [&](int x, int y) {
        const bool exists = edge.exists(levels[l].attributes.at(x, y));
        add_samples(exists,
                    exists ? pyramid_energies(edge, levels[l], levels[l + 1], {pixels, x, y})
                           : PyramidEnergies{},
                    edge.gamma());
      });
    }
    coarsest_ = levels.back().values.clone();
    weight_ = in.weight.clone();
  }

  /// The loss of the pyramid's result against brute force. `weights` and `gradient` have one entry
  /// a pass; gradients are added, scaled by `scale`.
  ImageLoss loss(const PyramidWeights& weights, double scale,
                 std::vector<PassGradient>& gradient) const;

  /// The pyramid's result, and what it should be.
  [[nodiscard]] Planes<3> filter(const PyramidWeights& weights) const;
  [[nodiscard]] const Planes<3>& target() const { return target_; }
  [[nodiscard]] const Plane<float>& weight() const { return weight_; }  ///< of the inputs
  [[nodiscard]] int passes() const { return static_cast<int>(passes_.size()); }

 private:
  /// Range functions of the samples that pixels of a level gather; energies of coarser ones, times
  /// Edge::gamma().
  struct Samples {
    std::array<float, 9> fine, coarse, energy;
  };
  struct Pass {
    Plane<float> values;
    std::vector<Samples> samples;
    std::vector<char> exists;
  };
  struct Blend;
  using Field = std::vector<std::array<double, 4>>;

  template <typename Body>
  static void for_each_pixel(Extent extent, const Body& body) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) body(x, y);
    }
  }
  void add_pass(const Plane<float>& values);
  void add_samples(bool exists, const PyramidEnergies& energies, float gamma);
  [[nodiscard]] std::vector<Field> run(const PyramidWeights& weights) const;
  [[nodiscard]] Planes<3> divide(const Field& result) const;
  void pull_back(std::size_t level, const PyramidPass& pass, std::vector<Field>& results,
                 PassGradient& gradient) const;
  [[nodiscard]] Blend blend(const Pass& pass, const PyramidPass& weights, const Field& coarse,
                            int x, int y) const;

  std::vector<Pass> passes_;
  Plane<float> coarsest_;
  Planes<3> target_;
  Plane<float> weight_;
};

}  // namespace eigenlight
