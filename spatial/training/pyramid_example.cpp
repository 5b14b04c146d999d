#include "spatial/training/pyramid_example.h"

#include <cmath>

namespace eigenlight {

// Eq. 2 at one pixel, taken apart.
struct PyramidExample::Blend {
  std::array<double, 4> out{};           // I_up
  std::array<double, 4> mean{};          // of the finer samples by their range function
  std::array<double, 9> interpolated{};  // w_d f_c^R of coarser samples
  std::array<double, 9> kept{};          // f_c^R to the power of gamma
  double total = 0.0;
};

namespace {

std::size_t index(Extent extent, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(extent.width) +
         static_cast<std::size_t>(x);
}

int offset_x(std::size_t i) { return static_cast<int>(i) % 3 - 1; }
int offset_y(std::size_t i) { return static_cast<int>(i) / 3 - 1; }

Extent half(Extent extent) { return {(extent.width + 1) / 2, (extent.height + 1) / 2}; }

std::size_t coarser_index(Extent extent, std::size_t i, int x, int y) {
  return index(half(extent), x / 2 + offset_x(i), y / 2 + offset_y(i));
}

}  // namespace

void PyramidExample::add_pass(const Plane<float>& values) {
  passes_.push_back({values.clone(), {}, {}});
  passes_.back().samples.reserve(values.extent().pixels());
}

void PyramidExample::add_samples(bool exists, const PyramidEnergies& energies, float gamma) {
  Samples samples{};
  for (std::size_t i = 0; i < 9 && exists; ++i) {
    samples.fine[i] = std::exp(-energies.fine[i]);
    samples.coarse[i] = std::exp(-energies.coarse[i]);
    // Where the range function is 0 its energy has no part in anything.
    samples.energy[i] = samples.coarse[i] > 0.0f ? gamma * energies.coarse[i] : 0.0f;
  }
  passes_.back().samples.push_back(samples);
  passes_.back().exists.push_back(exists ? 1 : 0);
}

PyramidExample::Blend PyramidExample::blend(const Pass& pass, const PyramidPass& weights,
                                            const Field& coarse, int x, int y) const {
  const Extent extent = pass.values.extent();
  const Samples& samples = pass.samples[index(extent, x, y)];
  Blend b;
  double alike = 0.0, moved = 0.0;
  for (std::size_t i = 0; i < 9; ++i) {
    if (const double range = samples.fine[i]; range > 0.0) {
      const float* from = pass.values.at(x + offset_x(i), y + offset_y(i));
      const double w = static_cast<double>(weights.fine[i]) * range;
      for (std::size_t c = 0; c < 4; ++c) {
        b.out[c] += w * static_cast<double>(from[c]);
        b.mean[c] += range * static_cast<double>(from[c]);
      }
      b.total += w;
      alike += range;
    }
    if (const double range = samples.coarse[i]; range > 0.0) {
      const auto& from = coarse[coarser_index(extent, i, x, y)];
      b.interpolated[i] = range * static_cast<double>(pyramid_interpolation(x % 2, offset_x(i)) *
                                                      pyramid_interpolation(y % 2, offset_y(i)));
      b.kept[i] = std::exp(-static_cast<double>(weights.gamma) * samples.energy[i]);
      const double basic = b.interpolated[i] * static_cast<double>(weights.coarse[i]);
      for (std::size_t c = 0; c < 4; ++c) b.out[c] += basic * b.kept[i] * from[c];
      moved += basic * (1.0 - b.kept[i]);
      b.total += basic;
    }
  }
  for (std::size_t c = 0; c < 4; ++c) {
    b.mean[c] /= alike;
    b.out[c] = (b.out[c] + moved * b.mean[c]) / b.total;
  }
  return b;
}

std::vector<PyramidExample::Field> PyramidExample::run(const PyramidWeights& weights) const {
  EL_CHECK(weights.size() == passes_.size(), "{} passes of pyramid weights: expected {}",
           weights.size(), passes_.size());
  std::vector<Field> results(passes_.size() + 1);
  for_each_pixel(coarsest_.extent(), [&](int x, int y) {
    const float* value = coarsest_.at(x, y);
    results.back().push_back({value[0], value[1], value[2], value[3]});
  });
  for (std::size_t l = passes_.size(); l-- > 0;) {
    const Pass& pass = passes_[l];
    results[l].resize(pass.samples.size());
    for_each_pixel(pass.values.extent(), [&](int x, int y) {
      const std::size_t at = index(pass.values.extent(), x, y);
      if (pass.exists[at] != 0) results[l][at] = blend(pass, weights[l], results[l + 1], x, y).out;
    });
  }
  return results;
}

Planes<3> PyramidExample::divide(const Field& result) const {
  Planes<3> out = make_planes<3>(target_[0].extent());
  for_each_pixel(out[0].extent(), [&](int x, int y) {
    const auto& value = result[index(out[0].extent(), x, y)];
    for (std::size_t c = 0; c < 3 && value[3] > 0.0; ++c) {
      out[c](x, y) = static_cast<float>(value[c] / value[3]);
    }
  });
  return out;
}

Planes<3> PyramidExample::filter(const PyramidWeights& weights) const {
  return divide(run(weights).front());
}

void PyramidExample::pull_back(std::size_t level, const PyramidPass& weights,
                               std::vector<Field>& results, PassGradient& gradient) const {
  // On entry results[level] holds d loss / d result of that level; the same is left in
  // results[level + 1].
  const Pass& pass = passes_[level];
  const Extent extent = pass.values.extent();
  const Field& coarse = results[level + 1];
  Field pulled(coarse.size());
  for_each_pixel(extent, [&](int x, int y) {
    const std::size_t at = index(extent, x, y);
    if (pass.exists[at] == 0) return;
    const Blend b = blend(pass, weights, coarse, x, y);
    const std::array<double, 4>& by_out = results[level][at];
    const auto along = [&](const auto& value) {
      double dot = 0.0;
      for (std::size_t c = 0; c < 4; ++c) {
        dot += by_out[c] * (static_cast<double>(value[c]) - b.out[c]);
      }
      return dot / b.total;
    };
    const double mean = along(b.mean);
    const Samples& samples = pass.samples[at];
    for (std::size_t i = 0; i < 9; ++i) {
      if (samples.fine[i] > 0.0f) {
        gradient.fine[i] += static_cast<double>(samples.fine[i]) *
                            along(pass.values.at(x + offset_x(i), y + offset_y(i)));
      }
      if (b.interpolated[i] == 0.0) continue;
      const std::size_t from = coarser_index(extent, i, x, y);
      const double sample = along(coarse[from]);
      const double basic = b.interpolated[i] * static_cast<double>(weights.coarse[i]);
      gradient.coarse[i] += b.interpolated[i] * (mean + b.kept[i] * (sample - mean));
      gradient.gamma -= basic * b.kept[i] * samples.energy[i] * (sample - mean);
      for (std::size_t c = 0; c < 4; ++c) {
        pulled[from][c] += by_out[c] * basic * b.kept[i] / b.total;
      }
    }
  });
  results[level + 1] = std::move(pulled);
}

ImageLoss PyramidExample::loss(const PyramidWeights& weights, double scale,
                               std::vector<PassGradient>& gradient) const {
  std::vector<Field> results = run(weights);
  const Planes<3> out = divide(results.front());
  Planes<3> by_out = make_planes<3>(out[0].extent());
  const ImageLoss loss = image_loss(out, target_, by_out);
  for_each_pixel(out[0].extent(), [&](int x, int y) {
    auto& value = results.front()[index(out[0].extent(), x, y)];
    const double weight = value[3];
    value = {};
    if (!(weight > 0.0)) return;
    for (std::size_t c = 0; c < 3; ++c) {
      value[c] = scale * static_cast<double>(by_out[c](x, y)) / weight;
      value[3] -= value[c] * static_cast<double>(out[c](x, y));
    }
  });
  for (std::size_t l = 0; l < passes_.size(); ++l) pull_back(l, weights[l], results, gradient[l]);
  return loss;
}

}  // namespace eigenlight
