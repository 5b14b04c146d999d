#include "sequences/pages/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/files/ldr_image.h"
#include "sequences/pages/develop.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kQuality = 85;  // noise stays noise, at a third of the bytes of quality 95

// One of the pictures of a frame, as the page sorts them.
struct View {
  const char* kind;
  const char* side;
  Planes<3> colors;
};

// Beauty with the frame's own noisy indirect light: color - indirect + noisy.
Planes<3> noisy_beauty(const Planes<3>& color, const Planes<3>& indirect, const Planes<3>& noisy) {
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

std::vector<View> read_views(const std::filesystem::path& path) {
  const ExrReader reader(path);
  const bool has_noisy = reader.has_layer("noisy") && reader.has_layer("indirect");
  std::vector<View> views;
  if (reader.has_layer("")) {
    Planes<3> color = reader.read_planes<3>("");
    if (has_noisy) {
      views.push_back(
          {"beauty", "noisy",
           noisy_beauty(color, reader.read_planes<3>("indirect"), reader.read_planes<3>("noisy"))});
    }
    views.push_back({"beauty", "denoised", std::move(color)});
  }
  if (reader.has_layer("indirect")) {
    if (has_noisy) views.push_back({"indirect", "noisy", reader.read_planes<3>("noisy")});
    views.push_back({"indirect", "denoised", reader.read_planes<3>("indirect")});
  }
  return views;
}

std::size_t bytes_of(const std::vector<View>& views, const Developer& developer, int factor) {
  std::size_t bytes = 0;
  for (const View& view : views) {
    bytes += encode_jpeg(developer.develop(view.colors, factor), kQuality).size();
  }
  return bytes;
}

// Frames that have a file, thinned evenly; whole steps, so that playing keeps its pace.
std::vector<int> thin(const std::vector<int>& frames, std::size_t most) {
  const std::size_t step = (frames.size() + most - 1) / most;
  std::vector<int> chosen;
  for (std::size_t i = 0; i < frames.size(); i += step) chosen.push_back(frames[i]);
  return chosen;
}

// The smallest factor that keeps all pictures within the limit, judged by the dearest of three
// frames.
int choose_factor(const std::vector<std::filesystem::path>& files, const Developer& developer,
                  const PictureOptions& options) {
  int factor = 1;
  for (const std::size_t i : {std::size_t{0}, files.size() / 2, files.size() - 1}) {
    const std::vector<View> views = read_views(files[i]);
    while (!views.empty() &&
           bytes_of(views, developer, factor) * files.size() > options.max_bytes &&
           Developer::shrunk(views[0].colors[0].extent(), factor) != Extent{1, 1}) {
      ++factor;
    }
  }
  return factor;
}

std::string note_of(std::size_t shown, std::size_t all, int factor) {
  std::string note = "Keys: space plays, left and right step. Drag the divider.";
  if (shown < all) note += fmt::format(" {} of {} frames are shown.", shown, all);
  if (factor > 1) note += fmt::format(" Shown at 1/{} of the size.", factor);
  return note + " Magenta marks NaN and Inf.";
}

}  // namespace

Json report_pictures(const std::filesystem::path& dir, const std::vector<int>& frames,
                     const PictureOptions& options) {
  const FilePattern pattern(kFramePattern);
  std::vector<int> present;
  for (const int frame : frames) {
    std::error_code error;
    if (std::filesystem::exists(dir / pattern.name(frame), error)) present.push_back(frame);
  }
  Json pictures = {{"frames", Json::array()}, {"kinds", Json::object()}};
  if (present.empty()) return pictures;

  const std::vector<int> shown = thin(present, options.max_frames);
  std::vector<std::filesystem::path> files;
  for (const int frame : shown) files.push_back(dir / pattern.name(frame));
  const Developer developer(options.exposure);
  const int factor = choose_factor(files, developer, options);
  for (const std::filesystem::path& file : files) {
    for (const View& view : read_views(file)) {
      const Plane<std::uint8_t> picture = developer.develop(view.colors, factor);
      pictures["kinds"][view.kind][view.side].push_back(
          jpeg_data_uri(encode_jpeg(picture, kQuality)));
      pictures["width"] = picture.width();
      pictures["height"] = picture.height();
    }
  }
  if (pictures["kinds"].empty()) return pictures;
  pictures["frames"] = shown;
  pictures["fps"] = static_cast<double>(options.frames_per_second) *
                    static_cast<double>(shown.size()) / static_cast<double>(present.size());
  pictures["note"] = note_of(shown.size(), present.size(), factor);
  return pictures;
}

}  // namespace eigenlight
