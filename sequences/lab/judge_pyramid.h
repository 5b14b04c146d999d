// The trained weights of the pyramid filter, judged on pictures that they were not trained on.
#pragma once

#include "sequences/lab/train_pyramid.h"
#include "sequences/metrics/similarity.h"

namespace eigenlight {

/// A kind of picture (painted, noisy, file, frame) at a radius: means over its pictures.
struct PyramidJudgement {
  std::string kind;
  int radius = 0;
  int pictures = 0;
  Similarity trained, untrained;  ///< against brute force
};

/// Painted pictures clean and noisy, files, and frames, at one radius; kinds without a picture are
/// left out. Throws as make_pyramid_examples() does.
[[nodiscard]] std::vector<PyramidJudgement> judge_pyramid(const PyramidPictures& pictures,
                                                          int radius, int side);

}  // namespace eigenlight
