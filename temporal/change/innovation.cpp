#include "temporal/change/innovation.h"

namespace eigenlight {

void InnovationOptions::validate() const {
  EL_CHECK(threshold >= 0.0f && threshold <= 100.0f, "threshold {}: expected [0, 100]", threshold);
  EL_CHECK(max_age >= 1.0f && max_age <= 255.0f, "max_age {}: expected [1, 255] frames", max_age);
}

}  // namespace eigenlight
