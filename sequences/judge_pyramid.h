// `eigenlight judge-pyramid`: the table of the pyramid filter's weights, on pictures that it was
// not trained on.
#pragma once

#include "sequences/console.h"
#include "sequences/likeness.h"
#include "sequences/train_pyramid.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// A kind of picture (painted, noisy, file, frame) at a radius: means over its pictures.
struct PyramidJudgement {
  std::string kind;
  int radius = 0;
  int pictures = 0;
  Likeness trained, untrained;  ///< against brute force
};

/// Painted pictures clean and noisy, files, and frames, at one radius; kinds without a picture are
/// left out. Throws as make_pyramid_examples() does.
[[nodiscard]] std::vector<PyramidJudgement> judge_pyramid(const PyramidPictures& pictures,
                                                          int radius, int side);

/// Adds the sub-command, which judges when it is parsed and prints a table in Markdown to
/// `console.out`. `console` must outlive `app`.
void add_judge_pyramid_command(CLI::App& app, const Console& console);

}  // namespace eigenlight
