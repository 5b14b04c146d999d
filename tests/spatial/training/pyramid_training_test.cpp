#include <gtest/gtest.h>

#include <cmath>

#include "frame/random.h"
#include "spatial/training/pyramid_trainer.h"
#include "spatial/training/training_images.h"
#include "tests/support/compare.h"

namespace eigenlight {
namespace {

// A painted picture with its colors as guide.
struct Picture {
  Picture(Extent extent, std::uint32_t seed)
      : image(paint_training_image(extent, seed)), attributes(extent, 3), weight(extent) {
    weight.fill(1.0f);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        for (std::size_t c = 0; c < 3; ++c) attributes.at(x, y)[c] = image[c](x, y);
      }
    }
  }
  [[nodiscard]] PyramidExample example(float radius, float sigma = 0.1f) const {
    return {ColorEdge{sigma, radius}, {attributes, image, weight}};
  }

  Planes<3> image;
  Plane<float> attributes, weight;
};

// Weights that are neither at a bound nor symmetric.
PyramidWeights uneven_weights(std::size_t passes) {
  PyramidWeights weights(passes);
  std::uint32_t n = 0;
  for (PyramidPass& pass : weights) {
    for (float& w : pass.fine) w = 0.05f + 0.2f * to_unit(hash_key(9u, n++));
    for (float& w : pass.coarse) w = 0.3f + 0.7f * to_unit(hash_key(9u, n++));
    pass.gamma = 0.3f + 0.4f * to_unit(hash_key(9u, n++));
  }
  return weights;
}

double loss_of(const PyramidExample& example, const PyramidWeights& weights) {
  std::vector<PassGradient> unused(weights.size());
  return example.loss(weights, 1.0, unused).total();
}

double mse(const Planes<3>& a, const Planes<3>& b) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        sum += std::pow(static_cast<double>(a[c](x, y)) - static_cast<double>(b[c](x, y)), 2.0);
      }
    }
  }
  return sum / (3.0 * static_cast<double>(a[0].extent().pixels()));
}

TEST(PyramidTraining, ModelMatchesTheFilter) {
  const Picture picture({45, 39}, 3);
  const PyramidExample example = picture.example(16.0f);
  const PyramidTable& table = trained_pyramid_table();
  Planes<3> out = make_planes<3>({45, 39});
  Pyramid<ColorEdge>({45, 39}, {0.1f, 16.0f}, table)
      .process({picture.attributes, picture.image, picture.weight}, out);
  EXPECT_TRUE(planes_near(example.filter(table.weights(16.0f)), out, {1e-4, 1e-5}));
}

// The derivative of the L1 term jumps where a pixel is exact; with noise to both sides that is
// rare, and over a small step it does not show.
TEST(PyramidTraining, GradientsMatchFiniteDifferences) {
  const Picture picture({33, 26}, 4);
  const PyramidExample example = picture.example(4.0f, 0.15f);
  PyramidWeights weights = uneven_weights(3);
  std::vector<PassGradient> gradient(weights.size());
  (void)example.loss(weights, 1.0, gradient);
  double largest = 0.0;
  for (const PassGradient& g : gradient) largest = std::max(largest, std::abs(g.gamma));
  ASSERT_GT(largest, 1e-5);
  constexpr float kStep = 2e-3f;
  const auto check = [&](float& value, double found, const char* what, std::size_t i) {
    const float before = value;
    value = before + kStep;
    const double above = loss_of(example, weights), up = value;
    value = before - kStep;
    const double below = loss_of(example, weights), down = value;
    value = before;
    const double wanted = (above - below) / (up - down);
    EXPECT_NEAR(found, wanted, 0.02 * std::abs(wanted) + 2e-5) << what << " " << i;
  };
  for (std::size_t l = 0; l < weights.size(); ++l) {
    for (std::size_t i = 0; i < 9; ++i) {
      check(weights[l].fine[i], gradient[l].fine[i], "fine", 10 * l + i);
      check(weights[l].coarse[i], gradient[l].coarse[i], "coarse", 10 * l + i);
    }
    check(weights[l].gamma, gradient[l].gamma, "gamma", l);
  }
}

TEST(PyramidTraining, LossGradientMatchesFiniteDifferences) {
  const Planes<3> a = paint_training_image({21, 17}, 1), b = paint_training_image({21, 17}, 2);
  Planes<3> gradient = make_planes<3>({21, 17}), unused = make_planes<3>({21, 17});
  EXPECT_NEAR(image_loss(a, a, gradient).total(), 0.0, 1e-12);
  (void)image_loss(a, b, gradient);
  Planes<3> moved = make_planes<3>({21, 17});
  copy_planes(a, moved);
  for (const auto& [x, y] : {std::array{0, 0}, std::array{10, 8}, std::array{20, 16}}) {
    for (std::size_t c = 0; c < 3; ++c) {
      constexpr float kStep = 1e-3f;
      moved[c](x, y) = a[c](x, y) + kStep;
      const double above = image_loss(moved, b, unused).total();
      moved[c](x, y) = a[c](x, y) - kStep;
      const double below = image_loss(moved, b, unused).total();
      moved[c](x, y) = a[c](x, y);
      const double wanted = (above - below) / (2.0 * static_cast<double>(kStep));
      EXPECT_NEAR(static_cast<double>(gradient[c](x, y)), wanted, 1e-2 * std::abs(wanted) + 1e-8);
    }
  }
}

TEST(PyramidTraining, TrainingLowersTheLossAndKeepsSymmetry) {
  std::vector<PyramidExample> examples;
  for (std::uint32_t seed : {1u, 2u}) examples.push_back(Picture({40, 40}, seed).example(4.0f));
  double last = 1e9;
  const TrainingResult result = train_pyramid(examples, untrained_pyramid_weights(4.0f),
                                              {.steps = 12}, [&](int, double loss) {
                                                EXPECT_LE(loss, last);
                                                last = loss;
                                                return true;
                                              });
  EXPECT_LT(result.last_loss, 0.8 * result.first_loss);
  EXPECT_EQ(result.last_loss, last);
  for (const PyramidPass& pass : result.weights) {
    for (const auto* w : {&pass.fine, &pass.coarse}) {
      for (const std::size_t i : {1u, 5u, 7u}) EXPECT_FLOAT_EQ((*w)[i], (*w)[3]);
      for (const std::size_t i : {2u, 6u, 8u}) EXPECT_FLOAT_EQ((*w)[i], (*w)[0]);
    }
  }
}

TEST(PyramidTraining, CallbackStopsTraining) {
  std::vector<PyramidExample> examples;
  examples.push_back(Picture({16, 16}, 1).example(1.0f));
  int steps = 0;
  (void)train_pyramid(examples, untrained_pyramid_weights(1.0f), {.steps = 50},
                      [&](int step, double) { return (steps = step + 1) < 3; });
  EXPECT_EQ(steps, 3);
  EXPECT_THROW((void)train_pyramid({}, untrained_pyramid_weights(1.0f), {}, {}),
               std::invalid_argument);
  EXPECT_THROW((void)train_pyramid(examples, untrained_pyramid_weights(1.0f), {.steps = -1}, {}),
               std::invalid_argument);
}

// The committed table on a picture that it was not trained on, against the untrained weights of
// section 5.1(e). It is trained to remove noise too, so its lead shrinks as the radius grows.
TEST(PyramidTraining, TrainedTableIsCloserToBruteForce) {
  const Picture picture({72, 72}, 1001);
  for (const auto& [radius, share] :
       {std::pair(1.0f, 0.05), {3.0f, 0.12}, {8.0f, 0.35}, {16.0f, 0.5}, {24.0f, 0.55}}) {
    const PyramidExample example = picture.example(radius);
    const double trained =
        mse(example.filter(trained_pyramid_table().weights(radius)), example.target());
    const double untrained =
        mse(example.filter(untrained_pyramid_weights(radius)), example.target());
    EXPECT_LT(trained, share * untrained) << "radius " << radius;
    EXPECT_GT(-10.0 * std::log10(trained), 40.0) << "radius " << radius;
  }
}

TEST(PyramidTraining, BruteForceWithoutEdgesIsAGaussian) {
  Plane<float> attributes({41, 41}, 3), weight({41, 41});
  weight.fill(1.0f);
  Planes<3> signal = make_planes<3>({41, 41}), out = make_planes<3>({41, 41});
  signal[1](20, 20) = 1.0f;
  const float sigma = pyramid_sigma(5.0f);
  bilateral_filter(ColorEdge{.blur_radius = 5.0f}, {attributes, signal, weight}, out);
  const float center = out[1](20, 20);
  EXPECT_NEAR(center, 1.0f / (6.2832f * sigma * sigma), 0.03f * center);
  EXPECT_NEAR(out[1](23, 22) / center, std::exp(-13.0f / (2.0f * sigma * sigma)), 1e-5f);
}

}  // namespace
}  // namespace eigenlight
