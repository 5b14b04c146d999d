// NAME.camera.json of any bytes: refused with one line that names the file, or every number of its
// cameras can be computed with.
#include <cmath>
#include <stdexcept>
#include <string>

#include "frame/bad_file.h"
#include "sequences/conventions/camera_file.h"
#include "sequences/files/atomic_file.h"
#include "tests/fuzz/target.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_camera(const Camera& camera) {
  FUZZ_CHECK(finite(camera.eye) && std::isfinite(camera.focal) && camera.focal > 0.0f);
  FUZZ_CHECK(std::isfinite(camera.center.x) && std::isfinite(camera.center.y));
  for (int axis = 0; axis < 3; ++axis) {
    const glm::vec3 column = camera.world_to_view[axis];
    FUZZ_CHECK(finite(column) && std::abs(glm::length(column) - 1.0f) < 0.01f);
  }
}

void check_file(std::string_view bytes) {
  static const TempDir dir;
  const auto path = dir / "a.camera.json";
  write_file_atomically(path, bytes);
  try {
    const CameraFile file(path);
    for (const int frame : {-1, 0, 1, 2, 3, 100}) {
      for (const Extent extent : {Extent{64, 64}, Extent{64, 36}, Extent{65536, 1}}) {
        try {
          if (const auto camera = file.camera(frame, extent)) check_camera(*camera);
        } catch (const BadFile&) {
          // Of another aspect.
        }
      }
    }
  } catch (const std::runtime_error& error) {
    const std::string_view message(error.what());
    FUZZ_CHECK(message.starts_with(path.string() + ": "));
    FUZZ_CHECK(message.find('\n') == std::string_view::npos);
  }
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eigenlight::check_file(eigenlight::as_text(data, size));
  return 0;
}
