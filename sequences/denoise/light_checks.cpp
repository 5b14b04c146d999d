#include "sequences/denoise/light_checks.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sequences/conventions/checks.h"
#include "sequences/conventions/motion.h"
#include "sequences/denoise/sum_check.h"
#include "sequences/exr/exr_colors.h"

namespace eigenlight {
namespace {

// Vectors within that of 0.5 are small motion, and so many of them must be.
constexpr float kNearHalf = 0.25f;
constexpr double kMostNear = 0.8;

void view_light(const RawFrame& frame, const FileLayer& layer, Planes<3>& planes) {
  for (int c = 0; c < 3; ++c) {
    const Plane<float>& plane = channel_of(frame.at(layer), c);
    planes[c] = plane.clone();
  }
}

LuminanceWeights weights_of(const RawFrame& frame, const FileLayer& layer) {
  const ExrFile& file = *frame.files[static_cast<std::size_t>(layer.input)];
  const auto found = file.attribute("chromaticities");
  const auto* colors = found ? std::get_if<ExrChromaticities>(&*found) : nullptr;
  return colors ? luminance_weights(*colors) : kRec709Weights;
}

}  // namespace

std::vector<std::string> check_lights(std::span<const RawFrame> frames, const ViewPlan& view,
                                      std::span<const RawGuides> guides, const Readings& readings) {
  std::vector<std::string> lines;
  if (view.is_denoised_already) {
    lines.emplace_back(
        "beauty: the renderer has denoised it already (there is a Noisy Image); layers of light "
        "are used, not it");
  }
  Planes<2> motion;
  if (readings.motion && guides.size() >= 2) {
    apply_motion(guides[1], &guides[0], *readings.motion, motion);
  }
  bool is_first = true;
  for (const PlannedLight& light : view.lights) {
    if (!light.layer || light.is_alpha) continue;
    const LuminanceWeights weights = weights_of(frames.front(), *light.layer);
    Planes<3> now;
    view_light(frames.front(), *light.layer, now);
    const std::string name = name_for_people(*light.layer);
    const auto say = [&](const std::optional<std::string>& line) {
      if (line) lines.push_back(fmt::format("{}: {}", name, *line));
    };
    say(check_correlated_noise(now, guides.front(), weights));
    if (frames.size() >= 2) {
      Planes<3> next;
      view_light(frames[1], *light.layer, next);
      say(check_frozen_seeds(now, next, motion, weights));
    }
    if (!std::exchange(is_first, false) || !view.albedo) continue;
    const auto line = check_noisy_feature(guides.front().albedo, now, "albedo", weights);
    if (line) lines.push_back(*line);
  }
  return lines;
}

bool are_encoded(std::span<const RawGuides> guides) {
  std::int64_t all = 0, near = 0;
  for (const RawGuides& frame : guides) {
    if (frame.motion.size() < 2) return false;
    const Plane<float>&horizontal = frame.motion[0], &vertical = frame.motion[1];
    for (int y = 0; y < horizontal.height(); ++y) {
      for (int x = 0; x < horizontal.width(); ++x) {
        const float u = horizontal(x, y), v = vertical(x, y);
        if (!(u >= 0.0f && u <= 1.0f && v >= 0.0f && v <= 1.0f)) return false;
        if (u == 0.0f && v == 0.0f) continue;  // the background has no color
        ++all;
        near += std::abs(u - 0.5f) <= kNearHalf && std::abs(v - 0.5f) <= kNearHalf;
      }
    }
  }
  return all > 0 && static_cast<double>(near) >= kMostNear * static_cast<double>(all);
}

}  // namespace eigenlight
