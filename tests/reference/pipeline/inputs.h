// Inputs of kernels in double, for their twins.
#pragma once

#include "tests/reference/image.h"

namespace eigenlight::twin {

using reference::Bases;
using reference::Coefficients;
using reference::Image;
using Light = reference::LightImages;

/// SumInputs in double.
struct Sums {
  const Bases& bases;
  const Planes<3>& light;
  const Image& variance;
  int active;
};

/// InnovationInputs in double.
struct Innovations {
  const Image &innovation, &age, &samples;
};

/// UpdateInputs in double.
struct Updates {
  const Coefficients &coefficients, &learning_rates;
  const Light& residual;
  const Light* correction;
  const Image &samples, &old_age, &new_age;
  int active, newborn;
};

/// CorrectionInputs in double.
struct CellInputs {
  const FrameInput& guides;
  const Light& residual;
  const Image &innovation, &age, &samples, &variance;
};

}  // namespace eigenlight::twin
