// Options of EigenDenoiser.
#pragma once

#include "reproject/taps.h"
#include "spatial/atrous.h"
#include "spatial/guided_filter.h"
#include "spatial/sample_budget.h"
#include "temporal/bases/coefficients.h"
#include "temporal/change/correction.h"
#include "temporal/change/innovation.h"
#include "temporal/samples/firefly_bound.h"

namespace eigenlight {

struct EigenOptions {
  TapOptions taps;
  ShrinkOptions shrink;
  FireflyOptions fireflies;
  CorrectionOptions correction;
  InnovationOptions innovation;
  BudgetOptions budget;
  GuidedOptions guided;
  AtrousOptions atrous;
  /// [0, 255] frames: pixels of lower age are blended with the guided filter's value, which has the
  /// weight 1 - age / limit.
  float young_age = 2.0f;
  /// [1, 255] frames: the longest age where light changes in ways that no basis explains. Filters
  /// remove the additional noise, but could not remove old light.
  float max_age_changing = 12.0f;
  /// [1, 255] frames: the longest age at edges whose history is blended (edges.h); at most 2/3 of
  /// the limit of the pixels around. Values of innovation.max_age or more turn the rule off.
  float max_age_edge = 12.0f;
  /// [0, 1] of the squared luminance: a tile whose variances all lie below it is not filtered.
  float quiet_variance = 1e-5f;
  /// [0, 1] of the pixels that must need correction before another basis is born.
  double birth_share = 0.1;
  /// Gains are ratios of sums of light (even_sums.h), for history with heavy noise; one basis.
  bool even_gain = false;
  bool project = true;     ///< solve for coefficients; else the light is taken to be steady
  bool correct = true;     ///< add the smoothed innovation
  bool filter = true;      ///< a-trous passes over the output
  bool look_back = true;   ///< the passes also find edges of light in the last output
  bool skip_still = true;  ///< no taps for frames in which nothing moves
  bool skip_empty = true;  ///< no work in tiles without surface

  void validate() const;  ///< throws std::invalid_argument naming the field
};

}  // namespace eigenlight
