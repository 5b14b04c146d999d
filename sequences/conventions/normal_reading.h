// What a normal layer means: its space, its axes and its encoding.
#pragma once

#include <span>
#include <string>

#include "frame/camera.h"
#include "frame/plane.h"
#include "sequences/conventions/depth_reading.h"
#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

/// What the normals of a file mean. Which side they are on does not matter: all are turned to face
/// the camera.
struct NormalReading {
  bool in_camera_space = false;  ///< else in world space
  bool is_encoded = false;       ///< 0 to 1 in place of -1 to 1
  /// From the file's axes to ours: view space (x right, y down, z forward) or world space. A
  /// permutation with signs.
  glm::mat3 axes{1.0f};
};

/// Readings compared with the slope of depth. Residuals are median angles in degrees; that of the
/// next is over the pixels where it differs from the best.
struct NormalFit {
  NormalReading reading, next;  ///< the best, and the one that comes closest to it
  double residual = 0.0, next_residual = 0.0;
  /// False: nothing to compare with, or no reading is clearly best. Then the reading is world
  /// space, and only its encoding was found (from lengths).
  bool is_clear = false;
  std::string words;  ///< one line for people
};

/// Compares the readings of normals with what the slope of depth and the camera say: world space as
/// it is or with y and z exchanged (y up, z up), camera space with y up or down and z into the
/// scene or toward the viewer, each -1 to 1 or 0 to 1. One to four frames; the more the camera
/// turns between them, the better are world and camera space told apart. Where all readings that
/// fit give the same normals, the first of them in that order is taken.
[[nodiscard]] NormalFit find_normal(std::span<const RawGuides> frames, const DepthReading& depth);

/// The unit normal in world space that faces the camera, or 0 where `raw` is 0 or not finite.
/// `camera` may be null: then view space is world space, and nothing is turned. Normals that face
/// away by less than 6 degrees (interpolated at silhouettes) are laid across the ray, others are
/// turned. `length`, if not null: that of the decoded normal, shorter than 1 where the samples of a
/// pixel differ.
[[nodiscard]] glm::vec3 world_normal(const glm::vec3& raw, const NormalReading& reading,
                                     const Camera* camera, int x, int y, float* length = nullptr);

/// The same for all pixels. `mean` keeps the length: in world space facing the camera, not unit.
/// `normal` is unit or 0. Both are sized.
void apply_normal(const Planes<3>& raw, const NormalReading& reading, const Camera* camera,
                  Planes<3>& normal, Planes<3>& mean);

}  // namespace eigenlight
