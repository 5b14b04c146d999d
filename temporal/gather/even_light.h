// Gives light back where a filter has lost it, and takes away what it has added.
#pragma once

#include "temporal/gather/color_record.h"
#include "temporal/gather/light_record.h"

namespace eigenlight {

/// Multiplies `light`, an estimate, by the light of the frame itself over it, both summed over
/// cells of 16 x 16 pixels and blurred over 5 x 5 of these (a tent, some 80 pixels wide):
///   light(p) *= (sum u + s n) / (sum light + s n),
/// s 2 % of the mean of the estimate over the picture, n the pixels that both know. Tests and
/// weights that read noise lose light: a bright sample is unlike its neighbors, and does not count.
/// The sum over thousands of pixels of the frame knows better, and its noise is small: light that a
/// sample finds with a chance of 1/30 makes 2 % of noise here. Ratios are kept in [1/2, 2]: beyond
/// that a single sample makes the light of a whole region.
void even_light(const LightRecord& own, Planes<3>& light);
/// The same for colors.
void even_light(const ColorRecord& own, Planes<3>& color);

}  // namespace eigenlight
