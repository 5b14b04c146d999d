// Whether a picture is the sum of its parts, and what it has beyond them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sequences/denoise/raw_frame.h"

namespace eigenlight {

/// Smallest color that light is divided by. Light over smaller colors is divided by this, and
/// multiplied by it again: nothing is lost, and nothing is divided by 0. 8-bit textures cannot tell
/// smaller colors apart.
inline constexpr float kSmallestColor = 0.01f;

/// One channel of a layer of light, as the file has it.
struct LightChannel {
  const Plane<float>* value = nullptr;  ///< null: what a sum has beyond its parts
  const Plane<float>* color = nullptr;  ///< null: 1
  bool is_divided = false;              ///< `value` is without `color`

  /// What denoised light is multiplied by before it is written. 1 for light that the file divides:
  /// such light is written as it is.
  [[nodiscard]] float written(int x, int y) const {
    if (is_divided || !color) return 1.0f;
    const float found = (*color)(x, y);
    return std::isfinite(found) ? std::max(found, kSmallestColor) : 1.0f;
  }
  /// What the layer's value is multiplied by in the beauty.
  [[nodiscard]] float shown(int x, int y) const {
    if (!is_divided || !color) return 1.0f;
    const float found = (*color)(x, y);
    return std::isfinite(found) ? found : 0.0f;
  }
};
[[nodiscard]] LightChannel light_channel(const PlannedLight& light, const RawFrame& frame,
                                         int channel);
/// Channel 0, 1 or 2 of a layer; gray layers have one for all.
[[nodiscard]] const Plane<float>& channel_of(const LayerPlanes& planes, int channel);

/// The channels of a sum: of itself and of its parts.
struct SumChannels {
  const Plane<float>* whole = nullptr;
  bool is_beauty = false;
  std::vector<LightChannel> lights;  ///< in the order of PlannedSum::lights
  std::vector<const Plane<float>*> emission;

  /// What a light's value is multiplied by in this sum.
  [[nodiscard]] float weight(std::size_t light, int x, int y) const {
    return is_beauty ? lights[light].shown(x, y) : 1.0f;
  }
};
[[nodiscard]] SumChannels sum_channels(const ViewPlan& view, const PlannedSum& sum,
                                       const RawFrame& frame, int channel);

/// The parts of a sum at one pixel, as the files have them.
struct SumOfParts {
  double value = 0.0;
  double size = 0.0;  ///< sum of the magnitudes of the parts
};
/// Emission and weight(i) * value of each light that stands in a file.
[[nodiscard]] SumOfParts parts_at(const SumChannels& in, int x, int y);

/// What a sum has beyond its parts, over one frame.
struct SumCheck {
  double mean = 0.0;      ///< of (sum - parts), over the mean of the sum
  double absolute = 0.0;  ///< mean of |sum - parts|, over the mean of |sum|
};
[[nodiscard]] SumCheck check_sum(const ViewPlan& view, const PlannedSum& sum,
                                 const RawFrame& frame);

/// The most that rounding leaves of a sum that is complete: files with 4 bits of mantissa, fewer
/// than any renderer writes, are 2 to 3 % off per pixel, and 0.1 % in the mean.
inline constexpr double kRoundingAbsolute = 0.04, kRoundingMean = 0.004;

/// Drops layers of light and guides that are 0 in all `frames`, and an alpha that is 0 or 1 in all,
/// and looks whether each sum is the sum of its parts. A beauty that has more than they explain
/// gets one more layer of light, all that is left, if there is room; one that has less than its
/// parts cannot be composed of them: it is denoised as a layer of its own, and so is a beauty whose
/// layers of light are all 0. Throws BadFile if there is nothing left to denoise. Rows of the table
/// are brought up to date, and lines for people added to `notes`.
void refine_plan(const std::vector<RawFrame>& frames, LayerPlan& plan,
                 std::vector<std::string>& notes);

}  // namespace eigenlight
