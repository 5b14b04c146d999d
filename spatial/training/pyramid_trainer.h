// Finds the pyramid's weights by descent.
#pragma once

#include <functional>
#include <vector>

#include "spatial/training/pyramid_example.h"

namespace eigenlight {

struct TrainingOptions {
  int steps = 120;  ///< [0, 10000]

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct TrainingResult {
  PyramidWeights weights;
  double first_loss = 0.0;  ///< of the start, mean over the examples
  double last_loss = 0.0;   ///< of the weights; never above first_loss
};

/// Starts from `start` and lowers the mean loss of `examples`, which all have start.size() passes:
/// Adam (Kingma and Ba 2015) on the logarithms of the weights and the logit of gamma, all examples
/// in each step. A step that raises the loss is taken back and the next is half as long (Xu et al.
/// 2024, section 3.3.2, rejects such steps, too).
///
/// Gradients are averaged over the eight symmetries of the square, which is to train on all eight
/// mirrored copies of each image. Weights thus keep these symmetries, without which Eq. 2g could
/// not hold for all four positions of a pixel within its coarser one; it then removes the 19th
/// unknown. `step_done` is called after each step with its number and the loss; it returns false to
/// stop early. The same bits for any number of threads.
[[nodiscard]] TrainingResult train_pyramid(const std::vector<PyramidExample>& examples,
                                           const PyramidWeights& start,
                                           const TrainingOptions& options,
                                           const std::function<bool(int, double)>& step_done);

/// A start for twice the radius: its passes from the second on are those of `weights`, because a
/// blur twice as wide looks the same one level higher; the first is its own neighbor's.
[[nodiscard]] PyramidWeights start_for_twice_the_radius(const PyramidWeights& weights);

}  // namespace eigenlight
