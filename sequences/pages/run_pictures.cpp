#include "sequences/pages/run_pictures.h"

#include <system_error>
#include <utility>

#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// The kinds of pictures that a file can hold.
enum Kind : std::size_t { kFull, kIndirect };

void add(const Planes<3>& light, float factor, Planes<3>& sum) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < sum[c].height(); ++y) {
      for (int x = 0; x < sum[c].width(); ++x) sum[c](x, y) += factor * light[c](x, y);
    }
  }
}

// The full picture as the frame's own samples have it: their sum where all are there, else the
// picture with noisy indirect light in place of what is denoised.
Planes<3> noisy_color(const ExrReader& reader) {
  const char* direct = reader.has_layer("noisy_direct") ? "noisy_direct" : "direct";
  if (reader.has_layer(direct) && reader.has_layer("emission")) {
    Planes<3> sum = reader.read_planes<3>("noisy");
    add(reader.read_planes<3>(direct), 1.0f, sum);
    add(reader.read_planes<3>("emission"), 1.0f, sum);
    return sum;
  }
  Planes<3> sum = reader.read_planes<3>("");
  add(reader.read_planes<3>("indirect"), -1.0f, sum);
  add(reader.read_planes<3>("noisy"), 1.0f, sum);
  return sum;
}

std::vector<SplitView> read_views(const fs::path& path) {
  const ExrReader reader(path);
  const auto read = [&](const char* layer) { return reader.read_planes<3>(layer); };
  const bool has_noisy = reader.has_layer("noisy") && reader.has_layer("indirect");
  std::vector<SplitView> views;
  if (reader.has_layer("")) {
    if (has_noisy) views.push_back({kFull, false, noisy_color(reader)});
    views.push_back({kFull, true, read("")});
  }
  if (reader.has_layer("indirect")) {
    if (has_noisy) views.push_back({kIndirect, false, read("noisy")});
    views.push_back({kIndirect, true, read("indirect")});
  }
  return views;
}

}  // namespace

PageGallery run_pictures(const fs::path& dir, const std::vector<int>& frames,
                         const PictureOptions& options) {
  const FilePattern pattern(kFramePattern);
  std::vector<int> present;
  for (const int frame : frames) {
    std::error_code error;
    if (fs::exists(dir / pattern.name(frame), error)) present.push_back(frame);
  }
  const SplitPictures pictures{{"full picture", "indirect light"},
                               [&](int frame) { return read_views(dir / pattern.name(frame)); }};
  return split_gallery(present, pictures, options);
}

}  // namespace eigenlight
