// A frame laid out for kernels that look far around each pixel.
#pragma once

#include "frame/frame.h"
#include "frame/tiles.h"
#include "spatial/rivals/spatial_filter.h"

namespace eigenlight {

/// Light that is filtered: 0 with weight 0 where there is none.
struct TapLight {
  Planes<3> color;
  Plane<float> weight;
};

/// Planes of the image with a margin of zeros on the left and the right, so that taps up to `reach`
/// pixels beside the image, in vectors of up to 16 floats, need no test. Rows have no margin.
///
/// A pixel is a surface where is_usable_surface() says so and its albedo is finite; all planes are
/// 0 elsewhere. Light is usable on surfaces where the weight is positive and finite and all three
/// channels are finite.
class TapPlanes {
 public:
  /// Throws std::invalid_argument on a bad size.
  TapPlanes(Extent extent, int reach);

  /// Takes over a frame of this extent (check_spatial).
  void load(const SpatialInputs& in);

  [[nodiscard]] Extent extent() const { return extent_; }
  /// Pixel (0, y) of a plane of this layout.
  [[nodiscard]] const float* row(const Plane<float>& plane, int y) const {
    return plane.row(y) + margin_;
  }
  [[nodiscard]] float* row(Plane<float>& plane, int y) const { return plane.row(y) + margin_; }
  [[nodiscard]] TapLight make_light() const;

  Planes<3> normal;
  Planes<3> position;  ///< world space, from the eye
  Planes<3> albedo;
  Plane<float> depth;
  Plane<float> surface;  ///< 1 or 0
  TapLight light;

 private:
  void load_pixel(const SpatialInputs& in, int x, int y);

  Extent extent_;
  int margin_;
  TileGrid grid_;
};

/// Throws std::invalid_argument, naming the filter `what`, unless all planes have `extent` and
/// `out` is not the signal.
void check_spatial(const SpatialInputs& in, const Planes<3>& out, Extent extent, const char* what);

}  // namespace eigenlight
