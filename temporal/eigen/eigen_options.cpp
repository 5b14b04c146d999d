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
  EL_CHECK(birth >= 0.0 && birth <= 1.0, "birth {}: expected [0, 1]", birth);
  EL_CHECK(young >= 0.0f && young <= 255.0f, "young {}: expected [0, 255] frames", young);
  EL_CHECK(changing >= 1.0f && changing <= 255.0f, "changing {}: expected [1, 255] frames",
           changing);
  EL_CHECK(edge >= 1.0f && edge <= 255.0f, "edge {}: expected [1, 255] frames", edge);
  EL_CHECK(quiet >= 0.0f && quiet <= 1.0f, "quiet {}: expected [0, 1]", quiet);
}

}  // namespace eigenlight
