// Surfaces, view rays and tangent planes of a vector of pixels, for kernels that compare surfaces.
// Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_FRAME_SURFACE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_FRAME_SURFACE_INL_H_
#undef EIGENLIGHT_FRAME_SURFACE_INL_H_
#else
#define EIGENLIGHT_FRAME_SURFACE_INL_H_
#endif

#include "frame/camera.h"
#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

struct Surface {
  VF3 normal;
  VF depth;
  VU id;
};

HWY_INLINE Surface LoadSurface(const GBuffer& surface, int x, int y) {
  return {Load(surface.normal, x, y), Load(surface.depth, x, y), Load(surface.id, x, y, U())};
}

/// Prefetches the pixels that LoadSurface() reads in the row below (frame/prefetch.h).
HWY_INLINE void PrefetchSurface(const GBuffer& surface, int x, int y) {
  prefetch_below(surface.depth, x, y);
  for (const auto& plane : surface.normal) prefetch_below(plane, x, y);
  prefetch_below(surface.id, x, y);
}

/// Axis x, y or z of view space, in world space.
HWY_INLINE VF3 ViewAxis(const Camera& camera, int axis) {
  const glm::mat3& m = camera.world_to_view;
  return {{Set(m[0][axis]), Set(m[1][axis]), Set(m[2][axis])}};
}

/// The view rays of a camera, with z = 1.
struct Rays {
  VF inverse_focal, center_x, center_y;

  HWY_INLINE explicit Rays(const Camera& camera)
      : inverse_focal(Set(1.0f / camera.focal)),
        center_x(Set(camera.center.x)),
        center_y(Set(camera.center.y)) {}

  /// x and y of the ray through a pixel coordinate.
  HWY_INLINE VF X(VF x) const { return Mul(Sub(x, center_x), inverse_focal); }
  HWY_INLINE VF Y(VF y) const { return Mul(Sub(y, center_y), inverse_focal); }

  /// N . ray, N in view space. Times depth it is the distance of the tangent plane from the eye.
  HWY_INLINE VF Along(const VF3& normal, VF x, VF y) const {
    return MulAdd(normal[0], X(x), MulAdd(normal[1], Y(y), normal[2]));
  }
};

/// The tangent planes of a vector of pixels from (x, y) on.
struct TangentPlanes {
  VF3 normal;
  VF x, y, c;   ///< N . ray through the center of pixel (i, j) = x i + y j + c
  VF distance;  ///< N . (X - eye)

  HWY_INLINE TangentPlanes(const Camera& camera, const VF3& own, VF depth, int column, int line)
      : normal(own) {
    const VF inverse_focal = Set(1.0f / camera.focal);
    x = Mul(DotInOrder(ViewAxis(camera, 0), normal), inverse_focal);
    y = Mul(DotInOrder(ViewAxis(camera, 1), normal), inverse_focal);
    c = NegMulAdd(
        x, Set(camera.center.x - 0.5f),
        NegMulAdd(y, Set(camera.center.y - 0.5f), DotInOrder(ViewAxis(camera, 2), normal)));
    distance = Mul(depth, Along(Iota(column), Set(line)));
  }

  HWY_INLINE VF Along(VF column, VF line) const { return MulAdd(x, column, MulAdd(y, line, c)); }
};

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
