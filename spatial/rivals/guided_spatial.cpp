#include "spatial/rivals/guided_spatial.h"

namespace eigenlight {

GuidedSpatial::GuidedSpatial(Extent extent, const GuidedOptions& options)
    : filter_(extent, options), wanted_(extent) {
  wanted_.fill(1);
}

void GuidedSpatial::process(const SpatialInputs& in, Planes<3>& out) {
  static_cast<void>(filter_.process({in.guides, in.signal, in.weight, wanted_}, out));
}

}  // namespace eigenlight
