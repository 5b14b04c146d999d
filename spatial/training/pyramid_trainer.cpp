#include "spatial/training/pyramid_trainer.h"

#include <algorithm>
#include <cmath>

#include "frame/tiles.h"

namespace eigenlight {
namespace {

constexpr std::size_t kNumbers = 19;  // of a pass: fine, coarse, gamma
// 0 has no logarithm, and a start far below 1 takes many steps.
constexpr double kSmallestStart = 0.02;
constexpr double kRate = 0.1;     // in logarithms; docs/experiments/2026-11-pyramid.md
constexpr double kGrowth = 1.05;  // of the rate after an accepted step
constexpr double kFirst = 0.9, kSecond = 0.999, kTiny = 1e-12;  // Kingma and Ba 2015; their epsilon

using Parameters = std::vector<double>;

double to_logit(double v) {
  const double inside = std::clamp(v, 0.02, 0.98);
  return std::log(inside / (1.0 - inside));
}
double from_logit(double v) { return 1.0 / (1.0 + std::exp(-v)); }

Parameters to_parameters(const PyramidWeights& weights) {
  Parameters parameters;
  for (const PyramidPass& pass : weights) {
    for (const auto* part : {&pass.fine, &pass.coarse}) {
      for (const float w : *part) {
        parameters.push_back(std::log(std::max(static_cast<double>(w), kSmallestStart)));
      }
    }
    parameters.push_back(to_logit(static_cast<double>(pass.gamma)));
  }
  return parameters;
}

PyramidWeights to_weights(const Parameters& parameters) {
  PyramidWeights weights(parameters.size() / kNumbers);
  const double* next = parameters.data();
  for (PyramidPass& pass : weights) {
    for (std::size_t i = 0; i < 9; ++i) {
      pass.fine[i] = static_cast<float>(std::exp(next[i]));
      pass.coarse[i] = static_cast<float>(std::exp(next[9 + i]));
    }
    pass.gamma = static_cast<float>(from_logit(next[18]));
    normalize_pass(pass);
    next += kNumbers;
  }
  return weights;
}

// Means over the center, the four edges and the four corners: the orbits of the square.
void symmetrize(std::array<double, 9>& values) {
  double edges = 0.0, corners = 0.0;
  for (std::size_t i = 0; i < 9; ++i) {
    if (i != 4) (i % 2 == 1 ? edges : corners) += values[i] / 4.0;
  }
  for (std::size_t i = 0; i < 9; ++i) {
    if (i != 4) values[i] = i % 2 == 1 ? edges : corners;
  }
}

struct Evaluation {
  double loss = 0.0;
  Parameters gradient;
};

Evaluation evaluate(const std::vector<PyramidExample>& examples, const Parameters& parameters) {
  const PyramidWeights weights = to_weights(parameters);
  const double share = 1.0 / static_cast<double>(examples.size());
  std::vector<std::vector<PassGradient>> gradients(examples.size());
  std::vector<double> losses(examples.size());
  parallel_for(static_cast<int>(examples.size()), [&](int i) {
    const auto n = static_cast<std::size_t>(i);
    gradients[n].resize(weights.size());
    losses[n] = examples[n].loss(weights, share, gradients[n]).total();
  });
  Evaluation result{0.0, Parameters(parameters.size())};
  for (std::size_t n = 0; n < examples.size(); ++n) {
    result.loss += share * losses[n];
    for (std::size_t l = 0; l < weights.size(); ++l) {
      PassGradient& g = gradients[n][l];
      symmetrize(g.fine);
      symmetrize(g.coarse);
      const PyramidPass& w = weights[l];
      double* to = result.gradient.data() + l * kNumbers;
      for (std::size_t i = 0; i < 9; ++i) {
        to[i] += g.fine[i] * static_cast<double>(w.fine[i]);
        to[9 + i] += g.coarse[i] * static_cast<double>(w.coarse[i]);
      }
      to[18] += g.gamma * static_cast<double>(w.gamma) * (1.0 - static_cast<double>(w.gamma));
    }
  }
  return result;
}

// Moments of the gradient.
class Adam {
 public:
  explicit Adam(std::size_t size) : mean_(size), square_(size) {}

  [[nodiscard]] Parameters step(const Parameters& from, const Parameters& gradient, double rate) {
    ++steps_;
    Parameters to = from;
    for (std::size_t i = 0; i < from.size(); ++i) {
      mean_[i] = kFirst * mean_[i] + (1.0 - kFirst) * gradient[i];
      square_[i] = kSecond * square_[i] + (1.0 - kSecond) * gradient[i] * gradient[i];
      const double mean = mean_[i] / (1.0 - std::pow(kFirst, steps_));
      const double square = square_[i] / (1.0 - std::pow(kSecond, steps_));
      to[i] -= rate * mean / (std::sqrt(square) + kTiny);
    }
    return to;
  }

 private:
  Parameters mean_, square_;
  int steps_ = 0;
};

}  // namespace

void TrainingOptions::validate() const {
  EL_CHECK(steps >= 0 && steps <= 10000, "training steps {}: expected 0 to 10000", steps);
}

TrainingResult train_pyramid(const std::vector<PyramidExample>& examples,
                             const PyramidWeights& start, const TrainingOptions& options,
                             const std::function<bool(int, double)>& step_done) {
  options.validate();
  EL_CHECK(!examples.empty(), "training of the pyramid: no image to learn from");
  Parameters parameters = to_parameters(start);
  Evaluation now = evaluate(examples, parameters);
  TrainingResult result{to_weights(parameters), now.loss, now.loss};
  Adam adam(parameters.size());
  double rate = kRate;
  for (int step = 0; step < options.steps; ++step) {
    const Parameters tried = adam.step(parameters, now.gradient, rate);
    Evaluation next = evaluate(examples, tried);
    if (next.loss <= now.loss) {
      parameters = tried;
      now = std::move(next);
      rate = std::min(rate * kGrowth, kRate);
    } else {
      rate *= 0.5;
    }
    if (!step_done(step, now.loss)) break;
  }
  result.weights = to_weights(parameters);
  result.last_loss = now.loss;
  return result;
}

PyramidWeights start_for_twice_the_radius(const PyramidWeights& weights) {
  PyramidWeights twice = weights;
  twice.insert(twice.begin(), weights.front());
  return twice;
}

}  // namespace eigenlight
