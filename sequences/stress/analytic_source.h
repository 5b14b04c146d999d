// A FrameSource of known truth: a textured plane, a camera that slides along it, changing light.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "frame/frame.h"
#include "frame/random.h"

namespace eigenlight {

/// Shape of one sample's noise, of mean 0 and variance 1.
enum class NoiseKind {
  kUniform,      ///< light is never negative up to a noise of 1 / sqrt(3)
  kExponential,  ///< skewed like path-traced light: many dark samples, few bright ones
};

struct AnalyticOptions {
  Extent extent{64, 36};
  int frames = 4;
  int first_frame = 0;
  int spp = 3;
  /// Standard deviation of one sample / its mean; 0: no noise.
  float noise = 0.5f;
  glm::vec2 slide{0.0f};  ///< pixels per frame that the camera moves; also the motion vector
  std::uint32_t seed = 0;
  /// Columns [0, sky_columns) have no surface.
  int sky_columns = 0;
  /// Factor on all indirect light in a frame.
  std::function<float(int)> gain = [](int) { return 1.0f; };
  /// Called on each frame before it is handed out, to add NaN, fireflies or cuts.
  std::function<void(Frame&)> edit = [](Frame&) {};
  NoiseKind noise_kind = NoiseKind::kUniform;
  /// Amplitude [0, 1] of the pattern of the light over the plane; 0: the same light everywhere.
  float pattern = 0.8f;
  bool is_gray = false;  ///< all channels have the same pattern
  /// Factor on the light at a point of the plane (in pixels of frame 0) in a frame, for changes
  /// that differ between points.
  std::function<float(glm::vec2, int)> light = [](glm::vec2, int) { return 1.0f; };
  /// Position of the camera in a frame, in pixels along the plane; null: frame * slide.
  std::function<glm::vec2(int)> path = nullptr;
};

class AnalyticSource final : public FrameSource {
 public:
  static constexpr float kDepth = 4.0f;

  explicit AnalyticSource(AnalyticOptions options)
      : options_(std::move(options)), next_(options_.first_frame) {}

  /// Noise-free indirect light (over albedo) at a pixel of a frame: smooth, 1 +- pattern times gain
  /// and light.
  [[nodiscard]] float truth(glm::ivec2 pixel, int channel, int frame) const {
    const glm::vec2 at = glm::vec2(pixel) + place(frame);
    const float phase = options_.is_gray ? 0.0f : 1.3f * static_cast<float>(channel);
    const float wave = std::sin(0.11f * at.x + phase) * std::cos(0.07f * at.y - phase);
    return options_.gain(frame) * options_.light(at, frame) * (1.0f + options_.pattern * wave);
  }

  [[nodiscard]] bool next(Frame& frame) override {
    if (next_ == options_.first_frame + options_.frames) return false;
    const int index = next_++;
    resampled_ = 0;
    frame.resize(options_.extent);
    frame.index = index;
    frame.previous_index = index - 1;
    frame.is_static = motion_to(index) == glm::vec2(0.0f);
    frame.spp = options_.spp;
    frame.camera = camera(index);
    frame.rays = static_cast<std::int64_t>(options_.extent.pixels()) * options_.spp;
    frame.non_finite_samples = 0;
    for (int y = 0; y < options_.extent.height; ++y) {
      for (int x = 0; x < options_.extent.width; ++x) fill({x, y}, frame);
    }
    options_.edit(frame);
    return true;
  }

  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override {
    ++resampled_;
    for (int y = 0; y < options_.extent.height; ++y) {
      for (int x = 0; x < options_.extent.width; ++x) {
        const int count = frame.surface.id(x, y) == 0 ? 0 : extra(x, y);
        frame.rays += count;
        for (int c = 0; c < 3; ++c) {
          const float mean = count > 0 ? sample_mean({x, y}, c, {frame.index, count}) : 0.0f;
          for (Planes<3>* layer : means) (*layer)[c](x, y) = mean;
        }
      }
    }
    return true;
  }

 private:
  struct Draw {
    int frame = 0, count = 0;
  };

  [[nodiscard]] glm::vec2 place(int frame) const {
    return options_.path ? options_.path(frame) : options_.slide * static_cast<float>(frame);
  }

  [[nodiscard]] glm::vec2 motion_to(int frame) const {
    return options_.path ? place(frame) - place(frame - 1) : options_.slide;
  }

  // Focal length in pixels and depth are such that a slide of one pixel is one unit over focal.
  [[nodiscard]] Camera camera(int frame) const {
    Camera camera;
    camera.focal = static_cast<float>(options_.extent.width);
    camera.center = 0.5f * glm::vec2(static_cast<float>(options_.extent.width),
                                     static_cast<float>(options_.extent.height));
    camera.eye = glm::vec3(place(frame) * (kDepth / camera.focal), 0);
    return camera;
  }

  // Mean of `count` samples: truth times 1 + noise * a draw of variance 1 / count. Samples of
  // next() have resampled_ 0, so those of resample() are independent of them.
  [[nodiscard]] float sample_mean(glm::ivec2 pixel, int channel, Draw draw) const {
    const std::uint32_t bits =
        hash_key(options_.seed, static_cast<std::uint32_t>(pixel.x),
                 static_cast<std::uint32_t>(pixel.y), static_cast<std::uint32_t>(draw.frame),
                 static_cast<std::uint32_t>(channel), static_cast<std::uint32_t>(resampled_));
    return truth(pixel, channel, draw.frame) * (1.0f + options_.noise * noise(bits, draw.count));
  }

  // Of mean 0 and variance 1 / count.
  [[nodiscard]] float noise(std::uint32_t bits, int count) const {
    const float inverse = 1.0f / static_cast<float>(count);
    if (options_.noise_kind == NoiseKind::kUniform) {
      return (to_unit(bits) - 0.5f) * std::sqrt(12.0f * inverse);
    }
    float sum = 0.0f;
    for (int i = 0; i < count; ++i) {
      sum -= std::log(1.0f - to_unit(hash_key(bits, static_cast<std::uint32_t>(i))));
    }
    return sum * inverse - 1.0f;
  }

  void fill(glm::ivec2 p, Frame& frame) const {
    const bool surface = p.x >= options_.sky_columns;
    frame.surface.id(p.x, p.y) = surface ? 1u : 0u;
    frame.surface.depth(p.x, p.y) = surface ? kDepth : std::numeric_limits<float>::infinity();
    frame.previous_depth(p.x, p.y) = frame.surface.depth(p.x, p.y);
    const glm::vec3 view = frame.camera.pixel_to_view(glm::vec2(p) + 0.5f) * kDepth;
    const glm::vec3 world = surface ? frame.camera.to_world(view) : glm::vec3(0.0f);
    const glm::vec2 motion = motion_to(frame.index);
    for (int c = 0; c < 3; ++c) {
      const auto plane = static_cast<std::size_t>(c);
      frame.surface.normal[plane](p.x, p.y) = surface && c == 2 ? -1.0f : 0.0f;
      frame.surface.albedo[plane](p.x, p.y) = surface ? 0.25f * static_cast<float>(c + 1) : 0.0f;
      frame.lights[0].radiance[plane](p.x, p.y) =
          surface ? sample_mean(p, c, {frame.index, options_.spp}) : 0.0f;
      frame.direct[plane](p.x, p.y) = surface ? 0.5f : 0.0f;
      frame.emission[plane](p.x, p.y) = surface ? 0.0f : 2.0f;
      frame.position[plane](p.x, p.y) = world[c];
    }
    frame.motion[0](p.x, p.y) = surface ? motion.x : 0.0f;
    frame.motion[1](p.x, p.y) = surface ? motion.y : 0.0f;
  }

  AnalyticOptions options_;
  int next_;
  int resampled_ = 0;
};

}  // namespace eigenlight
