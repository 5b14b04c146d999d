// Cameras of a sequence in a file beside it: NAME.camera.json.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "frame/camera.h"
#include "frame/plane.h"

namespace eigenlight {

/// A camera for each frame, as JSON:
///
///   {"width": 320, "height": 180, "frames": {"1": {"camera_to_world": [[4 numbers], 4 rows],
///                                                  "projection": [[4 numbers], 4 rows]}, ...}}
///
/// Matrices are row major, for column vectors, with Blender's axes: x right, y up, the camera looks
/// along -z (Object.matrix_world and Object.calc_matrix_camera of Blender). Other fields are
/// ignored.
class CameraFile {
 public:
  /// Reads the file. Throws std::runtime_error if it cannot be read, and BadFile naming file,
  /// field, what was wrong and what was expected.
  explicit CameraFile(std::filesystem::path path);

  /// The camera of `frame` for pictures of `extent`; nullopt if the file has none for that frame.
  /// Throws BadFile if the file is for pictures of another aspect (1 % is allowed).
  [[nodiscard]] std::optional<Camera> camera(int frame, Extent extent) const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  struct Entry {
    Camera camera;  // for pictures of width 1
    double aspect = 1.0;
  };

  std::filesystem::path path_;
  std::map<int, Entry> frames_;
};

}  // namespace eigenlight
