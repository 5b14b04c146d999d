#include "reproject/surface_history.h"

#include <utility>

namespace eigenlight {

void SurfaceHistory::keep(const FrameInput& frame) {
  known_ = true;
  index_ = frame.index;
  camera_ = frame.camera;
  surface_.depth.copy_from(frame.surface.depth);
  copy_planes(frame.surface.normal, surface_.normal);
  surface_.id.copy_from(frame.surface.id);
}

void SurfaceHistory::take(FrameInput& frame) {
  known_ = true;
  index_ = frame.index;
  camera_ = frame.camera;
  std::swap(surface_.depth, frame.surface.depth);
  std::swap(surface_.normal, frame.surface.normal);
  std::swap(surface_.id, frame.surface.id);
}

void SurfaceHistory::save(StateWriter& out, bool known, int index, const Camera& camera,
                          const GBuffer& surface) {
  out.value("known", known);
  out.value("index", index);
  out.value("camera", camera);
  out.plane("depth", surface.depth);
  out.planes("normal", surface.normal);
  out.plane("id", surface.id);
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
