// Motion and previous depth in our convention (frame/README.md): what is seen at p was at
// p + motion(p).
#pragma once

#include "frame/camera.h"
#include "frame/plane.h"
#include "sequences/conventions/motion_reading.h"
#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

/// The vectors of frame `now` in our convention. Forward vectors are those of `before`, brought to
/// the pixels around where they land; the nearest depth wins (the file's, in any reading). NaN
/// where the file's vector is not finite, where nothing lands, or everywhere if `before` is null or
/// has no motion and vectors are forward. Throws std::invalid_argument if the file lacks the
/// channels.
void apply_motion(const RawGuides& now, const RawGuides* before, const MotionReading& reading,
                  Planes<2>& motion);

/// Motion of points that do not move themselves. `depth` is in our convention. Where it is +inf,
/// the sky: only the camera's turning counts, previous depth is +inf. A point behind the previous
/// camera gets NaN and previous depth 0.
void motion_from_cameras(const Plane<float>& depth, const Camera& now, const Camera& before,
                         Planes<2>& motion, Plane<float>& previous_depth);

/// Cameras of two frames, for previous_depth_of().
struct CameraPair {
  Camera now, before;
};

/// The depth that each point had one frame ago. With `cameras` (null: none) where the vector agrees
/// with them to a quarter pixel plus 2 % of its length: that of a static point. Else the depth that
/// is found at p + motion(p), on the surface that is nearest to depth(p) there. 0 where the vector
/// leads out of the picture or is not finite, and +inf where depth is. Depths are in our
/// convention.
void previous_depth_of(const Planes<2>& motion, const Plane<float>& depth,
                       const Plane<float>& depth_before, const CameraPair* cameras,
                       Plane<float>& previous_depth);

}  // namespace eigenlight
