#include "sequences/lab/train_pyramid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "frame/bad_file.h"
#include "frame/random.h"
#include "render/builtin/builtin_scenes.h"
#include "render/live_source.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/ldr_image.h"
#include "sequences/runs/flythrough.h"
#include "spatial/training/training_images.h"

namespace eigenlight {
namespace {

// Sides of training images: windows of radius 16 and 64 fit several times.
constexpr int kSmallSide = 128, kLargeSide = 192;
constexpr int kLargestSmallRadius = 16;
constexpr std::array<float, 3> kColorSigmas{0.05f, 0.1f, 0.2f};
// Samples a pixel of noisy painted pictures.
constexpr std::array<int, 2> kPaintedSpp{1, 4};
constexpr int kNoisyEvery = 3;
// Sides of a rendered frame, in sides of the part that is taken.
constexpr int kFrameParts = 3;

Planes<3> crop_middle(const Planes<3>& image, int side, const std::string& name) {
  const Extent extent = image[0].extent();
  if (extent.width < side || extent.height < side) {
    throw BadFile(fmt::format("{}: {}x{} pixels, expected {} or more on each side", name,
                              extent.width, extent.height, side));
  }
  const int x0 = (extent.width - side) / 2, y0 = (extent.height - side) / 2;
  Planes<3> middle = make_planes<3>({side, side});
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < side; ++y) {
      std::copy_n(image[c].at(x0, y0 + y), side, middle[c].row(y));
    }
  }
  return middle;
}

Planes<3> read_image(const std::string& name) {
  return is_ldr_name(name) ? read_ldr_image(name) : ExrReader(name).read_colors("color");
}

// Light of `image` as a path tracer would see it: of one deviate for all channels.
Planes<3> add_noise(const Planes<3>& image, std::uint32_t seed, int samples) {
  Planes<3> noisy = make_planes<3>(image[0].extent());
  for (int y = 0; y < noisy[0].height(); ++y) {
    for (int x = 0; x < noisy[0].width(); ++x) {
      float mean = 0.0f;
      for (int s = 0; s < samples; ++s) {
        mean -= std::log(1.0f - to_unit(hash_key(seed, x, y, s))) / static_cast<float>(samples);
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const float light = mean * image[c](x, y);
        noisy[c](x, y) = light / (1.0f + light);
      }
    }
  }
  return noisy;
}

// `light` by the colors of `image`.
PyramidExample color_example(const Planes<3>& image, const Planes<3>& light, float sigma,
                             int radius) {
  const Extent extent = image[0].extent();
  Plane<float> attributes(extent, 3), weight(extent);
  weight.fill(1.0f);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) attributes.at(x, y)[c] = image[c](x, y);
    }
  }
  const ColorEdge edge{sigma, static_cast<float>(radius)};
  return {edge, {attributes, light, weight}};
}

PyramidExample frame_example(const std::string& scene_name, int number, int radius, int side) {
  Scene scene = make_builtin_scene(scene_name);
  // The middle of a picture as large as people render, so that surfaces span as many pixels.
  const Extent extent{kFrameParts * side, kFrameParts * side};
  const auto animation = make_flythrough(scene, Perturbation::kNone, extent);
  LiveSource source(scene, *animation, {.extent = extent, .spp = 1, .direct_spp = 0}, {number});
  Frame frame;
  if (!source.next(frame)) throw std::logic_error("a source of one frame has none");
  Plane<float> attributes({side, side}, GlobalIlluminationEdge::kAttributes);
  Plane<float> weight(attributes.extent());
  Planes<3> light = make_planes<3>(attributes.extent());
  const int margin = (extent.width - side) / 2;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const int fx = margin + x, fy = margin + y;
      if (frame.surface.id(fx, fy) == 0) continue;
      weight(x, y) = 1.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        attributes.at(x, y)[c] = frame.surface.normal[c](fx, fy);
        const float sample = frame.lights[0].radiance[c](fx, fy);
        light[c](x, y) = sample / (1.0f + sample);
      }
      attributes.at(x, y)[3] = frame.surface.depth(fx, fy);
    }
  }
  const GlobalIlluminationEdge edge{
      .normal_power = 64.0f, .depth_scale = 16.0f, .blur_radius = static_cast<float>(radius)};
  return {edge, {attributes, light, weight}};
}

PyramidWeights train_octave(const TrainPyramidOptions& options, int radius,
                            const PyramidWeights& start, const std::function<void()>& step,
                            TrainedRadius& report) {
  const int side = radius <= kLargestSmallRadius ? kSmallSide : kLargeSide;
  std::vector<PyramidExample> examples;
  for (NamedExample& one : make_pyramid_examples(options.pictures, radius, side)) {
    examples.push_back(std::move(one.example));
  }
  std::vector<PassGradient> unused(start.size());
  report.radius = radius;
  for (const PyramidExample& example : examples) {
    report.untrained_loss +=
        example.loss(untrained_pyramid_weights(static_cast<float>(radius)), 1.0, unused).total() /
        static_cast<double>(examples.size());
  }
  const TrainingResult result = train_pyramid(examples, start, options.training, [&](int, double) {
    step();
    return true;
  });
  report.trained_loss = result.last_loss;
  return result.weights;
}

}  // namespace

void PyramidPictures::validate() const {
  EL_CHECK(painted >= 0 && painted <= 64, "painted {}: expected 0 to 64 pictures", painted);
  EL_CHECK(painted > 0 || !images.empty() || !scenes.empty(),
           "nothing to learn from: no painted picture, no image, no scene");
  EL_CHECK(frame >= 0 && frame <= 100000, "frame {}: expected 0 to 100000", frame);
}

void TrainPyramidOptions::validate() const {
  pictures.validate();
  training.validate();
}

std::vector<NamedExample> make_pyramid_examples(const PyramidPictures& pictures, int radius,
                                                int side) {
  std::vector<NamedExample> examples;
  const auto add = [&](const std::string& name, const Planes<3>& image, const Planes<3>& light) {
    // Noisy ones have each deviation, too.
    const std::size_t turn = examples.size() + examples.size() / kNoisyEvery;
    const float sigma = kColorSigmas[turn % kColorSigmas.size()];
    examples.push_back({name, color_example(image, light, sigma, radius)});
  };
  for (int i = 0; i < pictures.painted; ++i) {
    const std::uint32_t seed = pictures.seed + static_cast<std::uint32_t>(i);
    const Planes<3> image = paint_training_image({side, side}, seed);
    if (i % kNoisyEvery != kNoisyEvery - 1) {
      add(fmt::format("painted {}", seed), image, image);
      continue;
    }
    const auto turn = static_cast<std::size_t>(i / kNoisyEvery) % kPaintedSpp.size();
    add(fmt::format("painted {}, noisy", seed), image, add_noise(image, seed, kPaintedSpp[turn]));
  }
  for (const std::string& name : pictures.images) {
    const Planes<3> image = crop_middle(read_image(name), side, name);
    add(name, image, image);
  }
  for (const std::string& name : pictures.scenes) {
    examples.push_back({name, frame_example(name, pictures.frame, radius, side)});
  }
  return examples;
}

PyramidTable train_pyramid_table(const TrainPyramidOptions& options,
                                 const std::function<void(const TrainedRadius&)>& done,
                                 const std::function<void()>& step) {
  options.validate();
  std::vector<PyramidWeights> octaves;
  for (int k = 0; k < kPyramidOctaves; ++k) {
    const int radius = 1 << k;
    const PyramidWeights start =
        k == 0 ? untrained_pyramid_weights(1.0f) : start_for_twice_the_radius(octaves.back());
    TrainedRadius report;
    octaves.push_back(train_octave(options, radius, start, step, report));
    done(report);
  }
  return PyramidTable(std::move(octaves));
}

}  // namespace eigenlight
