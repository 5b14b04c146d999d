// The surfaces of the frame before, which every history needs to follow them.
#pragma once

#include "frame/state.h"
#include "reproject/taps.h"

namespace eigenlight {

/// Number, camera and surfaces of the frame kept last.
class SurfaceHistory {
 public:
  /// Throws std::invalid_argument on a bad size.
  explicit SurfaceHistory(Extent extent) { surface_.resize(extent); }

  /// Whether `frame` leads back to the frame kept last; otherwise it is a cut.
  [[nodiscard]] bool is_followed_by(const FrameInput& frame) const {
    return known_ && index_ == frame.previous_index;
  }
  [[nodiscard]] PreviousSurface previous() const { return {camera_, surface_}; }

  /// `frame` has the size of the history.
  void keep(const FrameInput& frame);
  /// The same without copying, from a frame that is about to be overwritten: depth, normal and id
  /// of `frame` hold anything then.
  void take(FrameInput& frame);
  void reset() { known_ = false; }  ///< whatever comes next is a cut

  /// load() throws std::runtime_error on data that is not such a state of this size.
  void save(StateWriter& out) const { save(out, known_, index_, camera_, surface_); }
  /// What save() would write after keep(frame).
  static void save(StateWriter& out, const FrameInput& frame) {
    save(out, true, frame.index, frame.camera, frame.surface);
  }
  void load(StateReader& in);

 private:
  static void save(StateWriter& out, bool known, int index, const Camera& camera,
                   const GBuffer& surface);

  bool known_ = false;
  int index_ = 0;
  Camera camera_;
  GBuffer surface_;  // depth, normal and id
};

}  // namespace eigenlight
