// From the layers of files to the frames that the denoiser reads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "frame/frame.h"
#include "sequences/denoise/find_readings.h"

namespace eigenlight {

/// Builds the frames of one view, in the order of the sequence.
///
/// - Light is divided by its color where the file does not do so, and by kSmallestColor where that
///   is less.
/// - A pixel without surface but with light (the sky, edges over it) is a surface at kFarDepth that
///   faces the camera, so that its noise is removed as well; without light it is no surface.
/// - Pixels outside the data window are absent: no surface and no light.
/// - Without a layer of depth all surfaces are at depth 1, without normals they face the camera.
/// - Without a camera a frame has one with a view of 53 degrees, at rest. Only distances from the
/// planes of
///   surfaces depend on it.
class FrameBuilder {
 public:
  /// `view` and `readings` must outlive the builder. `cuts`: frames at which a new shot begins.
  FrameBuilder(const ViewPlan& view, const Readings& readings, const ExrWindow& canvas,
               std::vector<int> cuts);

  /// Fills `out`, reusing its planes. `previous_index` of the first frame is -1.
  void build(const std::shared_ptr<const RawFrame>& raw, Frame& out);

  /// Pixels with NaN or Inf in all frames so far, of each layer of light.
  [[nodiscard]] const std::vector<std::int64_t>& not_finite() const { return not_finite_; }

 private:
  void build_surface(const RawFrame& raw, const RawGuides& guides, Frame& out);
  void build_lights(const RawFrame& raw, Frame& out);
  void place_background(const RawFrame& raw, Frame& out) const;
  void build_motion(const RawGuides& guides, Frame& out);
  [[nodiscard]] bool has_history(int frame) const;

  const ViewPlan& view_;
  const Readings& readings_;
  ExrWindow canvas_;
  std::vector<int> cuts_;
  std::vector<std::int64_t> not_finite_;

  // Of the frame before.
  std::shared_ptr<const RawFrame> raw_before_;
  std::optional<Camera> camera_before_, camera_now_;
  Plane<float> depth_before_;
};

}  // namespace eigenlight
