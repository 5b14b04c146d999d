// Training of the pyramid filter's weights: from images to a table.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "spatial/training/pyramid_trainer.h"

namespace eigenlight {

/// Pictures to learn from, or to be judged by.
struct PyramidPictures {
  int painted = 8;                       ///< [0, 64] pictures painted by code; every third is noisy
  std::uint32_t seed = 0;                ///< of the first painted one; others follow
  std::vector<std::string> images = {};  ///< EXR, PNG or JPEG files, taken in their middle
  /// Built-in scenes of which one noisy frame each is rendered, for edges of geometry.
  std::vector<std::string> scenes{"atrium", "cornell", "gallery"};
  int frame = 20;  ///< [0, 100000] of the scenes' flythroughs

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct TrainPyramidOptions {
  PyramidPictures pictures;
  TrainingOptions training;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// What became of one radius.
struct TrainedRadius {
  int radius = 0;
  double untrained_loss = 0.0;  ///< of section 5.1(e)
  double trained_loss = 0.0;
};

struct NamedExample {
  std::string name;  ///< of the file, the scene, or `painted 3`
  PyramidExample example;
};

/// Images of `side` x `side` pixels, each with an edge-stopping function of `radius`: pictures and
/// files by their own colors, with deviations of 0.05, 0.1 and 0.2 by turns ("each with different
/// deviations", section 3.3.2); frames by normals and depth, their light at 1 sample a pixel mapped
/// to x / (1 + x).
///
/// The third, sixth .. painted picture is noise guided by the clean picture, as light is: each
/// pixel times the mean of 1 and of 4 exponential deviates by turns, mapped to x / (1 + x). Throws
/// BadFile naming a file that is smaller, std::runtime_error naming one that cannot be read.
[[nodiscard]] std::vector<NamedExample> make_pyramid_examples(const PyramidPictures& pictures,
                                                              int radius, int side);

/// Trains one octave after the other, each from the one before. `done` is called after each radius,
/// `step` after each step of descent; both may throw to end the training.
[[nodiscard]] PyramidTable train_pyramid_table(
    const TrainPyramidOptions& options, const std::function<void(const TrainedRadius&)>& done,
    const std::function<void()>& step);

}  // namespace eigenlight
