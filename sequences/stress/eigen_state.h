// The parts of a checkpoint of `eigenlight`.
#pragma once

#include "reproject/basis_field.h"
#include "reproject/surface_history.h"
#include "temporal/bases/coefficient_history.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// History of the method `eigenlight`; save and load know its order (EigenDenoiser::save).
struct EigenState {
  EigenState(Extent extent, int bases) : surfaces(extent), memory(extent, bases) {}

  /// Throws std::runtime_error if the denoiser has another extent or number of bases.
  void take(const Denoiser& denoiser) {
    StateWriter saved;
    denoiser.save(saved);
    StateReader in({saved.bytes().data(), saved.bytes().size()});
    int bases = 0, used = 0;
    in.value("eigenlight", version);
    in.value("layers", layers);
    surfaces.load(in);
    in.value("bases", bases);
    in.value("bases in use", used);
    EL_CHECK(bases == memory.bases(), "a history of {} bases, not {}", bases, memory.bases());
    field = BasisField(surfaces.previous().surface.depth.extent(), used);
    field.load(in);
    in.plane("variance", variance);
    in.plane("shown light", shown);
    memory.load(in);
  }

  void give(Denoiser& denoiser) const {
    StateWriter out;
    out.value("eigenlight", version);
    out.value("layers", layers);
    surfaces.save(out);
    out.value("bases", memory.bases());
    out.value("bases in use", field.bases());
    field.save(out);
    out.plane("variance", variance);
    out.plane("shown light", shown);
    memory.save(out);
    StateReader in({out.bytes().data(), out.bytes().size()});
    denoiser.load(in);
  }

  int version = 0, layers = 1;
  SurfaceHistory surfaces;
  BasisField field;
  Plane<float> variance, shown;
  CoefficientHistory memory;
};

}  // namespace eigenlight
