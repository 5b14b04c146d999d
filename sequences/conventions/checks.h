// Checks of a sequence before work on it: one line each, what it means, what to do.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "frame/luminance.h"
#include "frame/plane.h"
#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

/// What red, green and blue count in luminance. Default below: linear Rec. 709.
using LuminanceWeights = std::array<double, 3>;
inline constexpr LuminanceWeights kRec709Weights{kLuminance[0], kLuminance[1], kLuminance[2]};

/// Noise that is the same in both frames where nothing moves (motion under a hundredth of a pixel;
/// an empty `motion` means nowhere known: then all pixels are compared and must agree). Nothing
/// where fewer than 100 noisy pixels stand still.
[[nodiscard]] std::optional<std::string> check_frozen_seeds(
    const Planes<3>& before, const Planes<3>& now, const Planes<2>& motion,
    const LuminanceWeights& weights = kRec709Weights);

/// Correlation of the noise of neighbors on smooth surfaces, -1 to 1; about 0 for a box filter of
/// one pixel. nullopt where fewer than 500 pixels are noisy and smooth. `guides`: depth, normal and
/// albedo tell what is smooth; those absent do not count.
[[nodiscard]] std::optional<double> noise_correlation(
    const Planes<3>& light, const RawGuides& guides,
    const LuminanceWeights& weights = kRec709Weights);
[[nodiscard]] std::optional<std::string> check_correlated_noise(
    const Planes<3>& light, const RawGuides& guides,
    const LuminanceWeights& weights = kRec709Weights);

/// A feature (albedo, normal) whose noise, relative to its mean, is larger than that of the light.
/// `name` is what the line calls it.
[[nodiscard]] std::optional<std::string> check_noisy_feature(
    const Planes<3>& feature, const Planes<3>& light, std::string_view name,
    const LuminanceWeights& weights = kRec709Weights);

/// True where most of `now` is not found again in `before`: depth, normal and albedo, at
/// p + motion(p) (our convention; empty: at the same pixel), as in find_motion().
[[nodiscard]] bool is_cut(const RawGuides& now, const RawGuides& before, const Planes<2>& motion);

}  // namespace eigenlight
