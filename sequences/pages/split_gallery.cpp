#include "sequences/pages/split_gallery.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "sequences/files/ldr_image.h"
#include "sequences/pages/thin_frames.h"
#include "sequences/pages/tone_map.h"

namespace eigenlight {
namespace {

constexpr int kQuality = 85;  // keeps the noise, with a third of the bytes of quality 95

enum Side : std::size_t { kNoisy, kDenoised, kSides };

std::size_t total_bytes(const std::vector<SplitView>& views, const ToneMap& tone_map, int factor) {
  std::size_t bytes = 0;
  for (const SplitView& view : views) {
    bytes += encode_jpeg(tone_map.apply(view.colors, factor), kQuality).size();
  }
  return bytes;
}

// The smallest factor that keeps all pictures within the limit, judged by the largest of three
// frames.
int choose_factor(const std::vector<int>& frames, const SplitPictures& pictures,
                  const ToneMap& tone_map, std::size_t max_bytes) {
  int factor = 1;
  for (const std::size_t i : {std::size_t{0}, frames.size() / 2, frames.size() - 1}) {
    const std::vector<SplitView> views = pictures.read(frames[i]);
    while (!views.empty() && total_bytes(views, tone_map, factor) * frames.size() > max_bytes &&
           ToneMap::shrunk(views[0].colors[0].extent(), factor) != Extent{1, 1}) {
      ++factor;
    }
  }
  return factor;
}

// Data URIs by side and kind, and the size of the pictures.
struct Encoded {
  std::array<std::vector<std::vector<std::string>>, kSides> uris;
  Extent extent;
};

Encoded encode(const std::vector<int>& frames, const SplitPictures& pictures,
               const ToneMap& tone_map, int factor) {
  Encoded encoded;
  for (auto& kinds : encoded.uris) kinds.resize(pictures.kinds.size());
  for (const int frame : frames) {
    for (const SplitView& view : pictures.read(frame)) {
      const Plane<std::uint8_t> picture = tone_map.apply(view.colors, factor);
      encoded.uris[view.is_denoised ? kDenoised : kNoisy][view.kind].push_back(
          jpeg_data_uri(encode_jpeg(picture, kQuality)));
      encoded.extent = picture.extent();
    }
  }
  return encoded;
}

std::vector<GalleryKind> kinds_of(const Encoded& encoded, const SplitPictures& pictures) {
  std::vector<GalleryKind> kinds;
  for (std::size_t kind = 0; kind < pictures.kinds.size(); ++kind) {
    if (!encoded.uris[kDenoised][kind].empty()) kinds.push_back({pictures.kinds[kind], ""});
  }
  return kinds;
}

std::vector<GalleryTile> tiles_of(Encoded& encoded, const std::string& method) {
  const std::array<std::string, kSides> names{"noisy", "denoised (" + method + ")"};
  std::vector<GalleryTile> tiles;
  for (std::size_t side = 0; side < kSides; ++side) {
    GalleryTile tile{names[side], {}};
    for (auto& uris : encoded.uris[side]) {
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

PageGallery split_gallery(const std::vector<int>& frames, const SplitPictures& pictures,
                          const PictureOptions& options) {
  PageGallery gallery;
  gallery.is_split = true;
  if (frames.empty()) return gallery;
  const std::vector<int> shown = thin_frames(frames, options.max_frames);
  const ToneMap tone_map(options.exposure);
  const int factor = choose_factor(shown, pictures, tone_map, options.max_bytes);
  Encoded encoded = encode(shown, pictures, tone_map, factor);
  gallery.kinds = kinds_of(encoded, pictures);
  if (gallery.kinds.empty()) return gallery;
  gallery.tiles = tiles_of(encoded, options.method);
  gallery.frames = shown;
  gallery.frames_per_second = options.frames_per_second * static_cast<double>(shown.size()) /
                              static_cast<double>(frames.size());
  gallery.extent = encoded.extent;
  gallery.note = note_of(shown.size(), frames.size(), factor);
  return gallery;
}

}  // namespace eigenlight
