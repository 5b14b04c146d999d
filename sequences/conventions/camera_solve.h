// The camera of a frame: solved from a layer of positions, or from matrices in file headers.
#pragma once

#include <array>
#include <optional>

#include "frame/camera.h"
#include "frame/plane.h"

namespace eigenlight {

/// A camera and how well it explains where positions lie.
struct CameraFit {
  Camera camera;
  double residual = 0.0;       ///< pixels: root mean square over the positions that fit
  double outliers = 0.0;       ///< share of the positions that do not
  bool in_view_space = false;  ///< positions are in the space of the camera itself (pbrt's default)
};

/// The pinhole camera that maps `position` (world space) to pixel centers. Direct linear
/// transformation (Hartley and Zisserman 2004, algorithm 7.1) on a grid of pixels, then
/// Gauss-Newton steps on pixel distances with square pixels; the view axis is at the center of the
/// picture unless a shifted one fits far better. Left out: background by `depth` (may be empty),
/// positions that are not finite or exactly 0, and outliers. nullopt where there are fewer than 64
/// positions, where they lie in one plane, or where no pinhole camera fits them to 2 pixels. Throws
/// std::invalid_argument if depth has another extent.
[[nodiscard]] std::optional<CameraFit> solve_camera(const Planes<3>& position,
                                                    const Plane<float>& depth);

/// The camera of OpenEXR's standard attributes worldToCamera and worldToNDC, for row vectors
/// (p' = p M, translation in the last row). Which part of NDC is the picture is found from square
/// pixels: 0 to 1 with y down (OpenEXR, RenderMan, ours), -1 to 1 with y up (Arnold), -1 to 1 over
/// the width alone (Arnold's screen), or 0 to 1 over the shorter side with y up (pbrt).
/// worldToCamera tells whether y is up. In a left-handed world (pbrt) world_to_view is a
/// reflection. nullopt where the matrices are no pinhole camera with square pixels, or contradict
/// each other.
[[nodiscard]] std::optional<Camera> camera_from_matrices(
    const std::array<float, 16>& world_to_camera, const std::array<float, 16>& world_to_ndc,
    Extent display);

/// The camera of V-Ray's attributes cameraTransform and cameraFov: rows are the camera's axes in
/// world space, x right, y backward, z down (so read by the scripts for Nuke that turn it by -90
/// degrees about x), then its place; `fov` is horizontal, in degrees. nullopt unless the axes are
/// perpendicular and 0 < fov < 180.
[[nodiscard]] std::optional<Camera> camera_from_vray(const std::array<float, 16>& camera_transform,
                                                     float fov, Extent display);

}  // namespace eigenlight
