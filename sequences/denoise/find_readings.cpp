#include "sequences/denoise/find_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frame/bad_file.h"
#include "sequences/conventions/camera_solve.h"
#include "sequences/denoise/light_checks.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// Below this share of mismatch a still frame is its predecessor: half of what noise of features at
// 4 samples a pixel gives in the Cycles shots at the true vectors.
constexpr double kStillResidual = 0.02;

Plane<float> view_of(const Plane<float>& plane) {
  if (plane.height() < 2) return plane.clone();
  return Plane<float>::view(plane.row(0), plane.extent(),
                            static_cast<std::ptrdiff_t>(plane.stride() * sizeof(float)));
}

void view_layer(const RawFrame& frame, const std::optional<FileLayer>& layer, Planes<3>& planes) {
  if (!layer) return;
  const LayerPlanes& found = frame.at(*layer);
  for (std::size_t c = 0; c < 3; ++c) planes[c] = view_of(found[c]);
}

// NAME.camera.json beside NAME.####.exr.
fs::path camera_file_beside(const fs::path& input) {
  std::string stem = input.stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789-");
  stem.resize(digits == std::string::npos ? 0 : digits + 1);
  while (!stem.empty() && (stem.back() == '.' || stem.back() == '_')) stem.pop_back();
  return input.parent_path() / (stem + ".camera.json");
}

class Finder {
 public:
  Finder(std::span<const RawFrame> frames, const ViewPlan& view, const ExrWindow& canvas,
         const GuideChoice& choice, const fs::path& input)
      : frames_(frames), view_(view), canvas_(canvas), choice_(choice), input_(input) {}

  Readings find() {
    find_cameras();
    for (const RawFrame& frame : frames_) {
      guides_.push_back(raw_guides(frame, view_));
      guides_.back().camera = find_camera(frame, view_, readings_, canvas_);
    }
    find_surfaces();
    find_vectors();
    for (const std::string& line : check_lights(frames_, view_, guides_, readings_)) warn(line);
    return std::move(readings_);
  }

 private:
  void say(std::string text) { readings_.words.push_back(std::move(text)); }
  void warn(std::string text) { readings_.warnings.push_back(std::move(text)); }
  void find_cameras();
  [[nodiscard]] bool is_in_view_space() const;
  void find_surfaces();
  void find_vectors();
  void try_vectors();

  std::span<const RawFrame> frames_;
  const ViewPlan& view_;
  const ExrWindow& canvas_;
  const GuideChoice& choice_;
  const fs::path& input_;
  std::vector<RawGuides> guides_;
  Readings readings_;
};

void Finder::find_cameras() {
  std::error_code error;
  const fs::path beside = camera_file_beside(input_);
  const fs::path path = choice_.camera.empty() ? beside : fs::path(choice_.camera);
  if (!fs::exists(path, error) && !choice_.camera.empty()) {
    throw BadFile(fmt::format("--camera {}: no such file", choice_.camera));
  }
  if (!choice_.camera.empty() || fs::exists(path, error)) {
    readings_.camera_file.emplace(path);
    readings_.camera_from = CameraFrom::kFile;
    return say(fmt::format("camera: from {}", path.string()));
  }
  if (camera_of_header(*frames_.front().files.front())) {
    readings_.camera_from = CameraFrom::kHeader;
    return say("camera: from the file's header");
  }
  if (view_.position) {
    const RawGuides guides = raw_guides(frames_.front(), view_);
    if (const auto fit = solve_camera(guides.position, guides.depth)) {
      readings_.camera_from = CameraFrom::kPosition;
      readings_.in_view_space = is_in_view_space();
      if (readings_.in_view_space) {
        return say(fmt::format(
            "camera: its lens solved from {}, whose positions are in the space of the camera: how "
            "the camera moves is not known",
            name_for_people(*view_.position)));
      }
      return say(fmt::format("camera: solved from {}, residual {:.3f} pixels",
                             name_for_people(*view_.position), fit->residual));
    }
    return say(
        fmt::format("camera: none ({} fits no pinhole camera)", name_for_people(*view_.position)));
  }
  say("camera: none");
}

// A camera that stands at the origin of the world has such positions too: in one frame, not in all.
bool Finder::is_in_view_space() const {
  return std::all_of(frames_.begin(), frames_.end(), [&](const RawFrame& frame) {
    const RawGuides guides = raw_guides(frame, view_);
    const auto fit = solve_camera(guides.position, guides.depth);
    return fit && fit->in_view_space;
  });
}

void Finder::find_surfaces() {
  if (view_.depth) {
    const DepthFit fit = find_depth(guides_);
    readings_.depth = fit.reading;
    say(fit.words);
    if (fit.reading.along_ray && readings_.camera_from == CameraFrom::kNowhere) {
      readings_.depth.along_ray = false;
    }
  } else {
    warn("depth: none; history is accepted by normals, albedo and light alone");
  }
  if (view_.normal) {
    const NormalFit fit = find_normal(guides_, readings_.depth);
    readings_.normal = fit.reading;
    say(fit.words);
  } else {
    warn("normal: none; edges are found by depth and light alone");
  }
  if (!view_.albedo)
    warn("albedo: none; textures are in the light, and noise in them stays longer");
}

void Finder::find_vectors() {
  if (!choice_.motion.empty()) {
    readings_.motion = parse_motion(choice_.motion, {canvas_.width, canvas_.height});
    if (readings_.motion && !view_.motion) {
      throw std::invalid_argument(fmt::format(
          "--motion {}: the files have no layer of motion; name it with --map motion=LAYER",
          choice_.motion));
    }
    return say("motion: as --motion says, " + choice_.motion);
  }
  if (view_.motion && guides_.size() >= 2) return try_vectors();
  if (readings_.knows_poses()) {
    return say("motion: from cameras; moving objects have no history");
  }
  if (frames_.size() >= 2) {
    warn(
        "motion: none, and no camera; each frame is denoised without history. Add a layer of "
        "motion vectors, or name a file of cameras with --camera");
  }
}

void Finder::try_vectors() {
  const MotionFit fit = find_motion(guides_);
  // A scale that fits would only tell that most of the picture moves alike.
  const bool is_in_pixels =
      fit.is_clear && std::abs(fit.best.scale_x) == 1.0 && std::abs(fit.best.scale_y) == 1.0;
  if (!is_in_pixels && are_encoded(guides_)) {
    return warn(fmt::format(
        "motion: {} looks encoded as colors, 0 to 1 with 0.5 where nothing moves; it is not used. "
        "Write raw vectors (Arnold: Encode Raw Vector on){}",
        name_for_people(*view_.motion),
        readings_.knows_poses() ? "" : "; each frame is denoised without history"));
  }
  say(fit.words);
  if (fit.is_clear) {
    readings_.motion = fit.best;
    return;
  }
  // Clearly better than all readings that lead elsewhere in these frames: what is untold is a sign
  // or a unit that they do not need.
  if (fit.next_residual > kClearRatio * fit.residual &&
      fit.still_residual > kClearRatio * fit.residual) {
    readings_.motion = fit.best;
    return warn(fmt::format("motion: read as {} until further; say --motion if that is wrong",
                            format_motion(fit.best, {canvas_.width, canvas_.height})));
  }
  readings_.is_still = fit.still_residual < kStillResidual;
  if (readings_.is_still) return say("motion: nothing moves in the first frames");
  warn(fmt::format("motion: no reading of {} is clearly best; {}; say which with --motion",
                   name_for_people(*view_.motion),
                   readings_.knows_poses() ? "only the camera's motion is known"
                                           : "each frame is denoised without history"));
}

}  // namespace

RawGuides raw_guides(const RawFrame& frame, const ViewPlan& view) {
  RawGuides guides;
  guides.frame = frame.frame;
  if (view.depth) guides.depth = view_of(frame.at(*view.depth).front());
  view_layer(frame, view.normal, guides.normal);
  view_layer(frame, view.albedo, guides.albedo);
  view_layer(frame, view.position, guides.position);
  if (view.motion) {
    for (const Plane<float>& plane : frame.at(*view.motion)) {
      guides.motion.push_back(view_of(plane));
    }
  }
  return guides;
}

Readings find_readings(std::span<const RawFrame> frames, const ViewPlan& view,
                       const ExrWindow& canvas, const GuideChoice& choice, const fs::path& input) {
  return Finder(frames, view, canvas, choice, input).find();
}

}  // namespace eigenlight
