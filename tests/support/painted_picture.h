// An EXR file with a painted training picture.
#pragma once

#include <filesystem>
#include <vector>

#include "sequences/files/exr_io.h"
#include "spatial/training/training_images.h"

namespace eigenlight {

inline void write_painted_picture(const std::filesystem::path& path, Extent extent) {
  const Planes<3> image = paint_training_image(extent, 5);
  const std::vector<ExrChannel> channels{{"R", ExrType::kFloat, &image[0]},
                                         {"G", ExrType::kFloat, &image[1]},
                                         {"B", ExrType::kFloat, &image[2]}};
  write_exr(path, channels, {});
}

}  // namespace eigenlight
