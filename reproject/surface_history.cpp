#include "reproject/surface_history.h"

namespace eigenlight {

void SurfaceHistory::keep(const Frame& frame) {
  known_ = true;
  index_ = frame.index;
  camera_ = frame.camera;
  surface_.depth.copy_from(frame.surface.depth);
  copy_planes(frame.surface.normal, surface_.normal);
  surface_.id.copy_from(frame.surface.id);
}

void SurfaceHistory::save(StateWriter& out) const {
  out.value("known", known_);
  out.value("index", index_);
  out.value("camera", camera_);
  out.plane("depth", surface_.depth);
  out.planes("normal", surface_.normal);
  out.plane("id", surface_.id);
}

void SurfaceHistory::load(StateReader& in) {
  in.value("known", known_);
  in.value("index", index_);
  in.value("camera", camera_);
  in.plane("depth", surface_.depth);
  in.planes("normal", surface_.normal);
  in.plane("id", surface_.id);
}

}  // namespace eigenlight
