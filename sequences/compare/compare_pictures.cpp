#include "sequences/compare/compare_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "frame/tiles.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/files/ldr_image.h"
#include "sequences/pages/thin_frames.h"
#include "sequences/pages/tone_map.h"

namespace eigenlight {
namespace {

constexpr int kCropSide = 128;   // large enough to recognize the place, small enough to enlarge
constexpr int kHeatWidth = 480;  // pixels
constexpr std::size_t kMostFrames = 24;
constexpr int kQuality = 88;  // pages of three scenes and ten methods stay under 20 MB
// Ends of the logarithmic scale of heat maps. A viewer sees an error from about a fiftieth on.
constexpr double kLow = 0.02, kHigh = 2.0;

// Black, violet, red, orange, yellow: the lightness rises steadily, so gray prints keep the order.
constexpr std::array<std::array<double, 3>, 6> kRamp{
    {{0, 0, 4}, {66, 10, 104}, {147, 38, 103}, {221, 81, 58}, {252, 165, 10}, {252, 255, 164}}};

std::array<std::uint8_t, 3> ramp_color(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(kRamp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kRamp.size() - 2);
  const double t = at - static_cast<double>(i);
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] =
        static_cast<std::uint8_t>(std::lround((1.0 - t) * kRamp[i][c] + t * kRamp[i + 1][c]));
  }
  return color;
}

std::vector<std::string> ramp_css() {
  std::vector<std::string> colors;
  for (const auto& c : kRamp) colors.push_back(fmt::format("rgb({} {} {})", c[0], c[1], c[2]));
  return colors;
}

std::string uri(const Plane<std::uint8_t>& picture) {
  return jpeg_data_uri(encode_jpeg(picture, kQuality));
}

// (t - r) / sqrt(r^2 + 0.01) for each channel, with the reference r.
Planes<3> relative_error(const Planes<3>& test, const Planes<3>& reference) {
  Planes<3> error = make_planes<3>(test[0].extent());
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < test[c].height(); ++y) {
      for (int x = 0; x < test[c].width(); ++x) {
        const float r = reference[c](x, y);
        error[c](x, y) = (test[c](x, y) - r) / std::sqrt(r * r + 0.01f);
      }
    }
  }
  return error;
}

Planes<3> difference(const Planes<3>& a, const Planes<3>& b) {
  Planes<3> out = make_planes<3>(a[0].extent());
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) out[c](x, y) = a[c](x, y) - b[c](x, y);
    }
  }
  return out;
}

// Mean square over a rectangle and the channels, without NaN and Inf.
double mean_square(const Planes<3>& error, const Rect& tile) {
  double sum = 0.0, count = 0.0;
  for (const Plane<float>& plane : error) {
    for (int y = tile.y0; y < std::min(tile.y1, plane.height()); ++y) {
      for (int x = tile.x0; x < std::min(tile.x1, plane.width()); ++x) {
        const auto e = static_cast<double>(plane(x, y));
        if (!std::isfinite(e)) continue;
        sum += e * e;
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

Plane<std::uint8_t> heat_map(const Planes<3>& error) {
  const Extent extent = error[0].extent();
  const int factor = (extent.width + kHeatWidth - 1) / kHeatWidth;
  Plane<std::uint8_t> picture(ToneMap::shrunk(extent, factor), 3);
  parallel_for(picture.height(), [&](int y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Rect block{x * factor, y * factor, (x + 1) * factor, (y + 1) * factor};
      const double root = std::max(std::sqrt(mean_square(error, block)), kLow);
      const auto color = ramp_color(std::log(root / kLow) / std::log(kHigh / kLow));
      std::copy(color.begin(), color.end(), picture.at(x, y));
    }
  });
  return picture;
}

Planes<3> cut_out(const Planes<3>& image, const Rect& tile) {
  Planes<3> out = make_planes<3>({tile.x1 - tile.x0, tile.y1 - tile.y0});
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      std::copy(image[c].at(tile.x0, y), image[c].at(tile.x0, y) + (tile.x1 - tile.x0),
                out[c].row(y - tile.y0));
    }
  }
  return out;
}

class GalleryMaker {
 public:
  explicit GalleryMaker(const ComparePictures& in)
      : in_(in),
        tone_map_(in.exposure),
        frames_(thin_frames(in.plan.measured, kMostFrames)),
        crop_(find_crop()) {}

  [[nodiscard]] PageGallery make() {
    PageGallery gallery;
    gallery.title = "Pictures";
    gallery.note =
        fmt::format("{}. Space plays, the left and right arrow keys step.", in_.plan.shown_text());
    // The frames are thinned, but shown at the pace of the sequence.
    gallery.frames_per_second = kFramesPerSecond * static_cast<double>(frames_.size()) /
                                static_cast<double>(in_.plan.measured.size());
    gallery.frames = frames_;
    gallery.kinds = kinds();
    gallery.tiles.push_back(new_tile("reference"));
    for (const Contender& contender : in_.plan.contenders) {
      gallery.tiles.push_back(new_tile(contender.label));
    }
    previous_.resize(gallery.tiles.size());
    for (const int frame : in_.plan.measured) add_frame(frame, gallery.tiles);
    return gallery;
  }

 private:
  [[nodiscard]] std::vector<GalleryKind> kinds() const {
    const std::string low = fmt::format("{}", kLow), high = fmt::format("{}", kHigh);
    return {{"crop", fmt::format("Where {} has most error of {}: columns {} to {}, rows {} to {}",
                                 in_.plan.ours().label, in_.plan.measured_light(), crop_.x0,
                                 crop_.x1 - 1, crop_.y0, crop_.y1 - 1)},
            {"error",
             "Root of the relMSE of each pixel against the reference, including the noise of the "
             "reference",
             ramp_css(), low, high},
            {"change of error", "The same for the change of the error since the previous frame",
             ramp_css(), low, high}};
  }
  [[nodiscard]] Planes<3> error(const Contender& contender, int frame) const {
    return relative_error(in_.output(contender, frame), in_.reference(frame));
  }
  // Neighboring squares overlap by half, so that no fault is cut in two by all of them.
  [[nodiscard]] Tile find_crop() const {
    const Extent extent = in_.plan.extent;
    const int side = std::min({kCropSide, extent.width, extent.height});
    std::vector<std::pair<double, Tile>> squares;
    for (int y = 0; y + side <= extent.height; y += std::max(side / 2, 1)) {
      for (int x = 0; x + side <= extent.width; x += std::max(side / 2, 1)) {
        squares.push_back({0.0, {x, y, x + side, y + side, 0}});
      }
    }
    for (const int frame : frames_) {
      const Planes<3> of_frame = error(in_.plan.ours(), frame);
      for (auto& [sum, square] : squares) sum += mean_square(of_frame, square);
    }
    return std::max_element(squares.begin(), squares.end(),
                            [](const auto& a, const auto& b) { return a.first < b.first; })
        ->second;
  }
  [[nodiscard]] static GalleryTile new_tile(const std::string& name) {
    return {name, std::vector<std::vector<std::string>>(3)};
  }
  void add_frame(int frame, std::vector<GalleryTile>& tiles) {
    const Planes<3> mean = in_.reference(frame);
    // The error of A against the mean of A and B is as large as the error of that mean: it shows
    // the least error that the other heat maps can show.
    const Planes<3> half = in_.half(ReferenceCache::Half::kA, frame);
    add_picture(frame, mean, relative_error(half, mean), tiles[0], previous_[0]);
    for (std::size_t i = 0; i < in_.plan.contenders.size(); ++i) {
      const Planes<3> image = in_.output(in_.plan.contenders[i], frame);
      add_picture(frame, image, relative_error(image, mean), tiles[i + 1], previous_[i + 1]);
    }
  }
  // `before` is the error of the previous frame. The first frame has none: its change is black.
  void add_picture(int frame, const Planes<3>& image, Planes<3> error, GalleryTile& tile,
                   Planes<3>& before) const {
    if (std::find(frames_.begin(), frames_.end(), frame) != frames_.end()) {
      const bool is_first = before[0].empty();
      tile.pictures[0].push_back(uri(tone_map_.apply(cut_out(image, crop_), 1)));
      tile.pictures[1].push_back(uri(heat_map(error)));
      tile.pictures[2].push_back(
          uri(heat_map(is_first ? difference(error, error) : difference(error, before))));
    }
    before = std::move(error);
  }

  const ComparePictures& in_;
  ToneMap tone_map_;
  std::vector<int> frames_;
  Tile crop_;
  std::vector<Planes<3>> previous_;  // errors of the previous frame, by tile
};

}  // namespace

Planes<3> ComparePictures::reference(int frame) const {
  Planes<3> mean = half(ReferenceCache::Half::kA, frame);
  const Planes<3> other = half(ReferenceCache::Half::kB, frame);
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < mean[c].height(); ++y) {
      for (int x = 0; x < mean[c].width(); ++x) {
        mean[c](x, y) = 0.5f * (mean[c](x, y) + other[c](x, y));
      }
    }
  }
  return mean;
}

ComparePictures scene_pictures(const ComparePlan& plan, const ReferenceCache& references,
                               std::filesystem::path folder, float exposure) {
  return {
      plan, exposure,
      [&references](ReferenceCache::Half half, int frame) { return references.load(half, frame); },
      [folder = std::move(folder), is_whole = plan.is_whole](const Contender& contender,
                                                             int frame) {
        const ExrReader reader(folder / contender.label / FilePattern(kFramePattern).name(frame));
        const bool is_picture = is_whole || contender.external || contender.antialias;
        return reader.read_planes<3>(is_picture ? "" : "indirect");
      }};
}

PageGallery compare_gallery(const ComparePictures& pictures) {
  return GalleryMaker(pictures).make();
}

}  // namespace eigenlight
