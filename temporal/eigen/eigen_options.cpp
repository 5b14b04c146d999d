#include "temporal/eigen/eigen_options.h"

namespace eigenlight {

void EigenOptions::validate() const {
  taps.validate();
  shrink.validate();
  fireflies.validate();
  correction.validate();
  innovation.validate();
  budget.validate();
  guided.validate();
  atrous.validate();
  EL_CHECK(birth_share >= 0.0 && birth_share <= 1.0, "birth_share {}: expected [0, 1]",
           birth_share);
  EL_CHECK(young_age >= 0.0f && young_age <= 255.0f, "young_age {}: expected [0, 255] frames",
           young_age);
  EL_CHECK(max_age_changing >= 1.0f && max_age_changing <= 255.0f,
           "max_age_changing {}: expected [1, 255] frames", max_age_changing);
  EL_CHECK(max_age_edge >= 1.0f && max_age_edge <= 255.0f,
           "max_age_edge {}: expected [1, 255] frames", max_age_edge);
  EL_CHECK(quiet_variance >= 0.0f && quiet_variance <= 1.0f, "quiet_variance {}: expected [0, 1]",
           quiet_variance);
}

}  // namespace eigenlight
