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

// The full picture with the noisy indirect light of the frame: color - indirect + noisy.
Planes<3> noisy_color(const Planes<3>& color, const Planes<3>& indirect, const Planes<3>& noisy) {
  Planes<3> out = make_planes<3>(color[0].extent());
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < out[c].height(); ++y) {
      for (int x = 0; x < out[c].width(); ++x) {
        out[c](x, y) = color[c](x, y) - indirect[c](x, y) + noisy[c](x, y);
      }
    }
  }
  return out;
}

std::vector<SplitView> read_views(const fs::path& path) {
  const ExrReader reader(path);
  const auto read = [&](const char* layer) { return reader.read_planes<3>(layer); };
  const bool has_noisy = reader.has_layer("noisy") && reader.has_layer("indirect");
  std::vector<SplitView> views;
  if (reader.has_layer("")) {
    Planes<3> color = read("");
    if (has_noisy) {
      views.push_back({kFull, false, noisy_color(color, read("indirect"), read("noisy"))});
    }
    views.push_back({kFull, true, std::move(color)});
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
