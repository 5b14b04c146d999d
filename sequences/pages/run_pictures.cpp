#include "sequences/pages/run_pictures.h"

#include <fmt/format.h>

#include <array>
#include <system_error>
#include <utility>

#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/files/ldr_image.h"
#include "sequences/pages/thin_frames.h"
#include "sequences/pages/tone_map.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

constexpr int kQuality = 85;  // keeps the noise, with a third of the bytes of quality 95

// The kinds of pictures that a file can hold, and the two sides of the player.
enum Kind : std::size_t { kFull, kIndirect, kKinds };
enum Side : std::size_t { kNoisy, kDenoised, kSides };
constexpr std::array<const char*, kKinds> kKindNames{"full picture", "indirect light"};

struct View {
  Kind kind;
  Side side;
  Planes<3> colors;
};

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

std::vector<View> read_views(const fs::path& path) {
  const ExrReader reader(path);
  const auto read = [&](const char* layer) { return reader.read_planes<3>(layer); };
  const bool has_noisy = reader.has_layer("noisy") && reader.has_layer("indirect");
  std::vector<View> views;
  if (reader.has_layer("")) {
    Planes<3> color = read("");
    if (has_noisy) {
      views.push_back({kFull, kNoisy, noisy_color(color, read("indirect"), read("noisy"))});
    }
    views.push_back({kFull, kDenoised, std::move(color)});
  }
  if (reader.has_layer("indirect")) {
    if (has_noisy) views.push_back({kIndirect, kNoisy, read("noisy")});
    views.push_back({kIndirect, kDenoised, read("indirect")});
  }
  return views;
}

std::size_t total_bytes(const std::vector<View>& views, const ToneMap& tone_map, int factor) {
  std::size_t bytes = 0;
  for (const View& view : views) {
    bytes += encode_jpeg(tone_map.apply(view.colors, factor), kQuality).size();
  }
  return bytes;
}

// The smallest factor that keeps all pictures within the limit, judged by the largest of three
// frames.
int choose_factor(const std::vector<fs::path>& files, const ToneMap& tone_map,
                  std::size_t max_bytes) {
  int factor = 1;
  for (const std::size_t i : {std::size_t{0}, files.size() / 2, files.size() - 1}) {
    const std::vector<View> views = read_views(files[i]);
    while (!views.empty() && total_bytes(views, tone_map, factor) * files.size() > max_bytes &&
           ToneMap::shrunk(views[0].colors[0].extent(), factor) != Extent{1, 1}) {
      ++factor;
    }
  }
  return factor;
}

// Data URIs by side and kind, and the size of the pictures.
struct Pictures {
  std::array<std::array<std::vector<std::string>, kKinds>, kSides> uris;
  Extent extent;
};

Pictures encode(const std::vector<fs::path>& files, const ToneMap& tone_map, int factor) {
  Pictures pictures;
  for (const fs::path& file : files) {
    for (const View& view : read_views(file)) {
      const Plane<std::uint8_t> picture = tone_map.apply(view.colors, factor);
      pictures.uris[view.side][view.kind].push_back(jpeg_data_uri(encode_jpeg(picture, kQuality)));
      pictures.extent = picture.extent();
    }
  }
  return pictures;
}

std::vector<GalleryKind> kinds_of(const Pictures& pictures) {
  std::vector<GalleryKind> kinds;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    if (!pictures.uris[kDenoised][kind].empty()) kinds.push_back({kKindNames[kind], ""});
  }
  return kinds;
}

std::vector<GalleryTile> tiles_of(Pictures& pictures, const std::string& method) {
  const std::array<std::string, kSides> names{"noisy", "denoised (" + method + ")"};
  std::vector<GalleryTile> tiles;
  for (std::size_t side = 0; side < kSides; ++side) {
    GalleryTile tile{names[side], {}};
    for (auto& uris : pictures.uris[side]) {
      if (!uris.empty()) tile.pictures.push_back(std::move(uris));
    }
    if (!tile.pictures.empty()) tiles.push_back(std::move(tile));
  }
  return tiles;
}

std::string note_of(std::size_t shown, std::size_t all, int factor) {
  std::string note =
      "Space plays, the left and right arrow keys step. Drag the divider. Magenta marks NaN and "
      "Inf.";
  if (shown < all) note += fmt::format(" {} of {} frames are shown.", shown, all);
  if (factor > 1) note += fmt::format(" The pictures are 1/{} of the rendered size.", factor);
  return note;
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
  PageGallery gallery;
  gallery.is_split = true;
  if (present.empty()) return gallery;

  const std::vector<int> shown = thin_frames(present, options.max_frames);
  std::vector<fs::path> files;
  for (const int frame : shown) files.push_back(dir / pattern.name(frame));
  const ToneMap tone_map(options.exposure);
  const int factor = choose_factor(files, tone_map, options.max_bytes);
  Pictures pictures = encode(files, tone_map, factor);
  gallery.kinds = kinds_of(pictures);
  if (gallery.kinds.empty()) return gallery;
  gallery.tiles = tiles_of(pictures, options.method);
  gallery.frames = shown;
  gallery.frames_per_second = options.frames_per_second * static_cast<double>(shown.size()) /
                              static_cast<double>(present.size());
  gallery.extent = pictures.extent;
  gallery.note = note_of(shown.size(), present.size(), factor);
  return gallery;
}

}  // namespace eigenlight
