#include "spatial/rivals/pyramid_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frame/check.h"

namespace eigenlight {
namespace {

constexpr std::size_t kCenter = 4;
constexpr std::size_t kNumbers = 19;  // of a pass

PyramidPass pass_through() {
  PyramidPass pass;
  pass.fine[kCenter] = 1.0f;
  return pass;
}

PyramidPass lerp(const PyramidPass& a, const PyramidPass& b, float t) {
  PyramidPass mix;
  for (std::size_t i = 0; i < 9; ++i) {
    mix.fine[i] = std::lerp(a.fine[i], b.fine[i], t);
    mix.coarse[i] = std::lerp(a.coarse[i], b.coarse[i], t);
  }
  mix.gamma = std::lerp(a.gamma, b.gamma, t);
  return mix;
}

void check_pass(const PyramidPass& pass, std::size_t octave) {
  const auto fits = [](float v) { return v >= 0.0f && std::isfinite(v); };
  EL_CHECK(std::all_of(pass.fine.begin(), pass.fine.end(), fits) &&
               std::all_of(pass.coarse.begin(), pass.coarse.end(), fits) && fits(pass.gamma),
           "pyramid weights of radius {}: expected numbers that are not negative", 1 << octave);
  EL_CHECK(pass.fine[kCenter] > 0.0f,
           "pyramid weights of radius {}: the center of the finer samples must not be 0",
           1 << octave);
}

std::vector<PyramidWeights> parse(std::span<const float> numbers) {
  std::vector<PyramidWeights> octaves(static_cast<std::size_t>(kPyramidOctaves));
  EL_CHECK(numbers.size() == kNumbers * kPyramidOctaves * (kPyramidOctaves + 1) / 2,
           "table of pyramid weights: {} numbers", numbers.size());
  const float* next = numbers.data();
  for (std::size_t k = 0; k < octaves.size(); ++k) {
    octaves[k].resize(k + 1);
    for (PyramidPass& pass : octaves[k]) {
      std::copy_n(next, 9, pass.fine.begin());
      std::copy_n(next + 9, 9, pass.coarse.begin());
      pass.gamma = next[18];
      next += kNumbers;
    }
  }
  return octaves;
}

}  // namespace

int pyramid_passes(float radius) {
  if (!(radius > 1.0f)) return 1;
  return 1 + static_cast<int>(std::ceil(std::log2(std::min(radius, kPyramidRadius))));
}

void normalize_pass(PyramidPass& pass) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < 9; ++i) {
    const int x = static_cast<int>(i) % 3 - 1, y = static_cast<int>(i) / 3 - 1;
    // Any of the four parities gives the same sum, if the weights have the symmetries of a square.
    const float interpolation = pyramid_interpolation(0, x) * pyramid_interpolation(0, y);
    sum += pass.fine[i] + interpolation * pass.coarse[i];
  }
  for (float& w : pass.fine) w /= sum;
  for (float& w : pass.coarse) w /= sum;
}

PyramidTable::PyramidTable(std::vector<PyramidWeights> octaves) : octaves_(std::move(octaves)) {
  EL_CHECK(octaves_.size() == kPyramidOctaves, "pyramid weights of {} octaves: expected {}",
           octaves_.size(), kPyramidOctaves);
  for (std::size_t k = 0; k < octaves_.size(); ++k) {
    EL_CHECK(octaves_[k].size() == k + 1, "pyramid weights of radius {}: {} passes, expected {}",
             1 << k, octaves_[k].size(), k + 1);
    for (const PyramidPass& pass : octaves_[k]) check_pass(pass, k);
  }
}

PyramidPass PyramidTable::at(float radius, int level) const {
  const auto entry = [&](int octave) {
    if (level > octave) return pass_through();
    return octaves_[static_cast<std::size_t>(octave)][static_cast<std::size_t>(level)];
  };
  if (!(radius > 0.0f)) return pass_through();
  if (radius < 1.0f) return lerp(pass_through(), entry(0), radius);
  const float octave = std::log2(std::min(radius, kPyramidRadius));
  const int below = std::min(static_cast<int>(octave), kPyramidOctaves - 2);
  return lerp(entry(below), entry(below + 1), octave - static_cast<float>(below));
}

PyramidWeights PyramidTable::weights(float radius) const {
  PyramidWeights all;
  for (int level = 0; level < pyramid_passes(radius); ++level) all.push_back(at(radius, level));
  return all;
}

PyramidWeights untrained_pyramid_weights(float radius) {
  PyramidWeights all;
  const double sigma = static_cast<double>(pyramid_sigma(radius));
  const double c = 2.0 * std::numbers::pi * sigma * sigma;
  for (int level = 0; level < pyramid_passes(radius); ++level) {
    const double area = std::pow(4.0, level);
    const double share = std::min(area * area * std::log(4.0) / (c * (area + c)), 1.0);
    PyramidPass pass;
    pass.fine[kCenter] = static_cast<float>(share);
    pass.coarse.fill(static_cast<float>(1.0 - share));
    all.push_back(pass);
  }
  return all;
}

const PyramidTable& untrained_pyramid_table() {
  static const PyramidTable kTable = [] {
    std::vector<PyramidWeights> octaves;
    for (int k = 0; k < kPyramidOctaves; ++k) {
      octaves.push_back(untrained_pyramid_weights(static_cast<float>(1 << k)));
    }
    return PyramidTable(std::move(octaves));
  }();
  return kTable;
}

const PyramidTable& trained_pyramid_table() {
  static const PyramidTable kTable(parse(trained_pyramid_numbers()));
  return kTable;
}

std::string pyramid_table_source(const PyramidTable& table, const std::string& command) {
  std::string text = fmt::format(
      "// Written by: {}\n// One block a radius, one paragraph a pass: 3 x 3 finer, 3 x 3 coarser, "
      "gamma.\n#include \"spatial/rivals/pyramid_weights.h\"\n\nnamespace eigenlight {{\nnamespace "
      "{{\n\n// clang-format off\nconstexpr float kNumbers[] = {{\n",
      command);
  const auto rows = [&](const std::array<float, 9>& w) {
    for (std::size_t i = 0; i < 9; i += 3) {
      text += fmt::format("  {:.6e}f, {:.6e}f, {:.6e}f,{}", w[i], w[i + 1], w[i + 2],
                          i == 6 ? "\n" : "");
    }
  };
  for (std::size_t k = 0; k < table.octaves().size(); ++k) {
    text += fmt::format("  // radius {}\n", 1 << k);
    for (const PyramidPass& pass : table.octaves()[k]) {
      rows(pass.fine);
      rows(pass.coarse);
      text += fmt::format("  {:.6e}f,\n", pass.gamma);
    }
  }
  return text +
         "};\n// clang-format on\n\n}  // namespace\n\nstd::span<const float> "
         "trained_pyramid_numbers() { return kNumbers; }\n\n}  // namespace eigenlight\n";
}

}  // namespace eigenlight
