// How well vectors lead to the same surface in another frame.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

/// A pixel of one frame and the vector that leads to the same point in the other.
struct PixelVector {
  int x = 0, y = 0;
  glm::vec2 vector{0.0f};  ///< pixels, y down
};

/// What is left when both ends of vectors are compared.
struct Mismatch {
  double residual = 1.0;  ///< mean of d^2 / (1 + d^2); 1 if most vectors lead out of the picture
  int pixels = 0;         ///< compared: those that do not
};

/// Compares depth, normal and albedo of `from` with those of `to` at the end of the vectors
/// (bilinear within a surface). d^2 is the sum of the squared differences of log depth over .02,
/// normal over .6 and albedo over .3, of those that both frames have: widths of a few times the
/// noise of features at 4 samples a pixel. The change of log depth that a move of the camera brings
/// to first order, a + b x + c y + e / depth, is fitted and left out.
[[nodiscard]] Mismatch compare_along(const RawGuides& from, const RawGuides& to,
                                     std::span<const PixelVector> vectors);

}  // namespace eigenlight
