#include "sequences/denoise/frame_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/tiles.h"
#include "sequences/conventions/background.h"
#include "sequences/conventions/motion.h"
#include "sequences/denoise/sum_check.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Of what is behind all surfaces: as far as depths go, so that only a turn of the camera moves it.
constexpr float kFarDepth = kFarthestDepth;
constexpr std::uint32_t kSurfaceId = 1, kBackgroundId = 2, kFirstFileId = 3;
// Vectors of one frame are taken to be steady over a gap of so many.
constexpr int kLongestGap = 8;

// A view of 53 degrees, as wide as the picture.
Camera assumed_camera(Extent extent) {
  Camera camera;
  camera.focal = static_cast<float>(extent.width);
  camera.center = {0.5f * static_cast<float>(extent.width),
                   0.5f * static_cast<float>(extent.height)};
  return camera;
}

glm::vec3 facing(const Camera& camera) {
  return -glm::vec3(camera.world_to_view[0][2], camera.world_to_view[1][2],
                    camera.world_to_view[2][2]);
}

void set_normal(GBuffer& surface, int x, int y, const glm::vec3& normal) {
  for (int c = 0; c < 3; ++c) surface.normal[c](x, y) = normal[c];
}

bool has_light(const FrameInput& frame, int x, int y) {
  return std::any_of(frame.lights.begin(), frame.lights.end(), [&](const NoisyLight& light) {
    return std::any_of(light.radiance.begin(), light.radiance.end(),
                       [&](const Plane<float>& plane) { return plane(x, y) != 0.0f; });
  });
}

void clear_pixel(FrameInput& frame, int x, int y) {
  frame.surface.id(x, y) = 0;
  frame.surface.depth(x, y) = kInfinity;
  set_normal(frame.surface, x, y, glm::vec3(0.0f));
  for (NoisyLight& light : frame.lights) {
    for (auto& plane : light.radiance) plane(x, y) = 0.0f;
  }
}

// What a light has beyond all parts of the beauty, channel by channel.
void build_rest(const RawFrame& raw, const ViewPlan& view, Planes<3>& radiance) {
  const auto beauty = std::find_if(view.sums.begin(), view.sums.end(), [&](const PlannedSum& sum) {
    return view.beauty && key_of(*view.beauty) == key_of(sum.layer);
  });
  for (int c = 0; c < 3; ++c) {
    const SumChannels in = sum_channels(view, *beauty, raw, c);
    parallel_for(in.whole->height(), [&](int y) {
      for (int x = 0; x < in.whole->width(); ++x) {
        const double whole = static_cast<double>((*in.whole)(x, y));
        radiance[c](x, y) = static_cast<float>(whole - parts_at(in, x, y).value);
      }
    });
  }
}

std::int64_t count_not_finite(const Planes<3>& planes) {
  std::int64_t count = 0;
  for (int y = 0; y < planes[0].height(); ++y) {
    for (int x = 0; x < planes[0].width(); ++x) {
      if (!std::isfinite(planes[0](x, y) + planes[1](x, y) + planes[2](x, y))) ++count;
    }
  }
  return count;
}

}  // namespace

FrameBuilder::FrameBuilder(const ViewPlan& view, const Readings& readings, const ExrWindow& canvas,
                           std::vector<int> cuts)
    : view_(view), readings_(readings), canvas_(canvas), cuts_(std::move(cuts)) {
  not_finite_.resize(view.lights.size());
}

bool FrameBuilder::has_history(int frame) const {
  if (!raw_before_) return false;
  const int gap = frame - raw_before_->frame;
  if (gap < 1 || gap > kLongestGap) return false;
  return std::none_of(cuts_.begin(), cuts_.end(),
                      [&](int cut) { return cut > raw_before_->frame && cut <= frame; });
}

void FrameBuilder::build_surface(const RawFrame& raw, const RawGuides& guides, Frame& out) {
  const Extent extent{canvas_.width, canvas_.height};
  const Camera* known = camera_now_ ? &*camera_now_ : nullptr;
  if (!guides.depth.empty()) {
    DepthReading reading = readings_.depth;
    if (!known) reading.along_ray = false;
    apply_depth(guides.depth, reading, known, out.surface.depth);
  } else {
    out.surface.depth.fill(1.0f);
  }
  if (!guides.normal[0].empty()) {
    apply_normal(guides.normal, readings_.normal, known, out.surface.normal, out.mean_normal);
  } else {
    for (auto& plane : out.surface.normal) plane.fill(0.0f);
    for (auto& plane : out.mean_normal) plane = {};
  }
  if (!guides.albedo[0].empty()) copy_planes(guides.albedo, out.surface.albedo);
  const auto ids = raw.ids.find(view_.view);
  const glm::vec3 front = facing(out.camera);
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      const std::uint32_t id = ids == raw.ids.end() ? 0 : ids->second(x, y);
      out.surface.id(x, y) = id == 0 ? kSurfaceId : kFirstFileId + id % (0xffffffffu - 8u);
      const auto& n = out.surface.normal;
      if (n[0](x, y) == 0.0f && n[1](x, y) == 0.0f && n[2](x, y) == 0.0f) {
        set_normal(out.surface, x, y, front);
      }
    }
  });
}

void FrameBuilder::build_lights(const RawFrame& raw, Frame& out) {
  out.lights.resize(view_.lights.size());
  for (std::size_t i = 0; i < view_.lights.size(); ++i) {
    Planes<3>& radiance = out.lights[i].radiance;
    ensure_extent(radiance, {canvas_.width, canvas_.height});
    out.lights[i].is_direct = view_.lights[i].is_direct;
    out.lights[i].is_glossy = view_.lights[i].is_glossy;
    const std::optional<FileLayer>& color = view_.lights[i].color;
    out.lights[i].color = color ? view_layer(raw.at(*color)) : Planes<3>{};
    if (!view_.lights[i].layer) {
      build_rest(raw, view_, radiance);
    } else {
      for (int c = 0; c < 3; ++c) {
        const LightChannel in = light_channel(view_.lights[i], raw, c);
        parallel_for(canvas_.height, [&](int y) {
          for (int x = 0; x < canvas_.width; ++x) {
            radiance[c](x, y) = (*in.value)(x, y) / in.written(x, y);
          }
        });
      }
    }
    not_finite_[i] += count_not_finite(radiance);
  }
}

void FrameBuilder::place_background(const RawFrame& raw, Frame& out) const {
  const ExrWindow& window = raw.present.at(view_.view);
  const int x0 = window.x - canvas_.x, y0 = window.y - canvas_.y;
  const glm::vec3 front = facing(out.camera);
  parallel_for(canvas_.height, [&](int y) {
    for (int x = 0; x < canvas_.width; ++x) {
      if (x < x0 || y < y0 || x >= x0 + window.width || y >= y0 + window.height) {
        clear_pixel(out, x, y);
      } else if (!std::isfinite(out.surface.depth(x, y))) {
        if (!has_light(out, x, y)) {
          clear_pixel(out, x, y);
          continue;
        }
        out.surface.depth(x, y) = kFarDepth;
        out.surface.id(x, y) = kBackgroundId;
        set_normal(out.surface, x, y, front);
      }
    }
  });
}

void FrameBuilder::build_motion(const RawGuides& guides, Frame& out) {
  const bool has_cameras = camera_now_ && camera_before_ && readings_.knows_poses();
  const bool is_known = readings_.motion || has_cameras || readings_.is_still;
  out.previous_index = -1;
  if (!has_history(guides.frame) || !is_known) return;
  out.previous_index = raw_before_->frame;
  const CameraPair cameras{out.camera, camera_before_.value_or(out.camera)};
  if (!readings_.motion) {
    motion_from_cameras(out.surface.depth, cameras.now, cameras.before, out.motion,
                        out.previous_depth);
    return;
  }
  const RawGuides before = raw_guides(*raw_before_, view_);
  apply_motion(guides, &before, *readings_.motion, out.motion);
  const int gap = guides.frame - raw_before_->frame;
  if (gap > 1) {
    for (auto& plane : out.motion) {
      for (float& value : plane.storage()) value *= static_cast<float>(gap);
    }
  }
  if (has_cameras) {
    // The sky has no vector of its own in most files; it moves as the camera turns.
    Planes<2> turned;
    Plane<float> unused;
    motion_from_cameras(out.surface.depth, cameras.now, cameras.before, turned, unused);
    for (int y = 0; y < canvas_.height; ++y) {
      for (int x = 0; x < canvas_.width; ++x) {
        if (out.surface.depth(x, y) != kFarDepth) continue;
        for (int c = 0; c < 2; ++c) out.motion[c](x, y) = turned[c](x, y);
      }
    }
  }
  previous_depth_of(out.motion, out.surface.depth, depth_before_, has_cameras ? &cameras : nullptr,
                    out.previous_depth);
}

void FrameBuilder::build(const std::shared_ptr<const RawFrame>& raw, Frame& out) {
  const Extent extent{canvas_.width, canvas_.height};
  const RawGuides guides = raw_guides(*raw, view_);
  out.lights.resize(view_.lights.size());
  out.resize_input(extent);
  out.index = raw->frame;
  out.is_static = false;
  out.spp = 1;
  camera_now_ = find_camera(*raw, view_, readings_, canvas_);
  out.camera = camera_now_.value_or(assumed_camera(extent));
  build_surface(*raw, guides, out);
  build_lights(*raw, out);
  place_background(*raw, out);
  build_motion(guides, out);
  raw_before_ = raw;
  camera_before_ = camera_now_;
  if (depth_before_.empty()) depth_before_ = Plane<float>(extent);
  depth_before_.copy_from(out.surface.depth);
}

}  // namespace eigenlight
