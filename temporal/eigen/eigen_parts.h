// The parts of `eigenlight` that can be turned off, to measure what each contributes.
#pragma once

#include <span>

#include "temporal/eigen/eigen_denoiser.h"

namespace eigenlight {

[[nodiscard]] std::span<const Part> eigen_parts();

/// `eigenlight` with the parts in options.without turned off. Throws std::invalid_argument on a
/// name that eigen_parts() does not have.
[[nodiscard]] std::unique_ptr<Denoiser> make_eigen_denoiser(const DenoiserOptions& options);

}  // namespace eigenlight
