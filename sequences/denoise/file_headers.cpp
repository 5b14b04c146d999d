#include "sequences/denoise/file_headers.h"

#include <fmt/format.h>

#include <algorithm>

#include "frame/bad_file.h"
#include "sequences/exr/exr_colors.h"
#include "sequences/files/frame_range.h"

namespace eigenlight {
namespace {

FileHeader read_header(const std::filesystem::path& path) {
  const ExrFile file(path);
  FileHeader header{path, file.display_window(), file.parts(), file.channels(), std::nullopt};
  const auto found = file.attribute("chromaticities");
  if (found && std::holds_alternative<ExrChromaticities>(*found)) {
    header.chromaticities = std::get<ExrChromaticities>(*found);
  }
  return header;
}

ExrWindow united(const ExrWindow& a, const ExrWindow& b) {
  if (a.width == 0) return b;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  const int x1 = std::max(a.x + a.width, b.x + b.width);
  const int y1 = std::max(a.y + a.height, b.y + b.height);
  return {x, y, x1 - x, y1 - y};
}

void check_display(const FileHeader& header, const FileHeader& first) {
  const ExrWindow &now = header.display, &before = first.display;
  if (now.width == before.width && now.height == before.height) return;
  throw BadFile(fmt::format("{}: display window of {}x{} pixels, expected {}x{} as in {}",
                            header.path.string(), now.width, now.height, before.width,
                            before.height, first.path.string()));
}

}  // namespace

std::vector<const FileLayer*> layers_read(const ViewPlan& view) {
  std::vector<const FileLayer*> layers;
  const auto add = [&](const std::optional<FileLayer>& layer) {
    if (layer) layers.push_back(&*layer);
  };
  for (const PlannedLight& light : view.lights) {
    add(light.layer);
    add(light.color);
  }
  for (const PlannedSum& sum : view.sums) layers.push_back(&sum.layer);
  for (const FileLayer& emission : view.emission) layers.push_back(&emission);
  add(view.beauty);
  add(view.albedo);
  add(view.normal);
  add(view.depth);
  add(view.position);
  add(view.motion);
  return layers;
}

const FileLayer& first_light(const ViewPlan& view) {
  for (const PlannedLight& light : view.lights) {
    if (light.layer) return *light.layer;
  }
  return *view.beauty;
}

std::vector<FrameHeaders> read_headers(const std::vector<FrameFiles>& frames) {
  std::vector<FrameHeaders> headers;
  for (const FrameFiles& frame : frames) {
    headers.emplace_back();
    for (const auto& path : frame.inputs) headers.back().push_back(read_header(path));
  }
  return headers;
}

std::vector<int> channel_indices(const std::vector<ExrChannelInfo>& channels,
                                 const std::string& path, const FileLayer& layer) {
  std::vector<int> indices;
  for (const std::string& name : layer.channels) {
    const auto found = std::find_if(channels.begin(), channels.end(), [&](const auto& channel) {
      return channel.full_name == name && channel.view == layer.view;
    });
    if (found == channels.end()) {
      throw BadFile(fmt::format(
          "{}: no channel '{}', which the first frame has; --skip leaves a layer out of all frames",
          path, name));
    }
    indices.push_back(static_cast<int>(found - channels.begin()));
  }
  return indices;
}

ExrWindow find_canvas(const std::vector<FrameHeaders>& headers, const LayerPlan& plan) {
  ExrWindow canvas{0, 0, 0, 0};
  for (const FrameHeaders& frame : headers) {
    for (const FileHeader& file : frame) check_display(file, headers.front().front());
    for (const ViewPlan& view : plan.views) {
      const FileLayer& light = first_light(view);
      const FileHeader& file = frame[static_cast<std::size_t>(light.input)];
      const int channel = channel_indices(file.channels, file.path.string(), light).front();
      const int part = file.channels[static_cast<std::size_t>(channel)].part;
      canvas = united(canvas, file.parts[static_cast<std::size_t>(part)].data);
    }
  }
  return canvas;
}

void check_layers(const std::vector<FrameHeaders>& headers, const LayerPlan& plan) {
  for (const FrameHeaders& frame : headers) {
    for (const ViewPlan& view : plan.views) {
      std::vector<const FileLayer*> layers = layers_read(view);
      if (view.id) layers.push_back(&*view.id);
      for (const FileLayer* layer : layers) {
        const FileHeader& file = frame[static_cast<std::size_t>(layer->input)];
        (void)channel_indices(file.channels, file.path.string(), *layer);
      }
    }
  }
}

std::string other_primaries(const std::vector<FrameHeaders>& headers) {
  const auto colors = [](const FileHeader& file) {
    return file.chromaticities.value_or(rec709_chromaticities());
  };
  const FileHeader& first = headers.front().front();
  std::size_t count = 0;
  const FileHeader* other = nullptr;
  for (const FrameHeaders& frame : headers) {
    for (const FileHeader& file : frame) {
      if (same_colors(colors(file), colors(first))) continue;
      if (!other) other = &file;
      ++count;
    }
  }
  if (!other) return {};
  return fmt::format(
      "chromaticities: {} of {} files have other primaries than {}, the first of them {}; numbers "
      "are "
      "taken as they are, and each file keeps its own",
      count, headers.size() * headers.front().size(), first.path.string(), other->path.string());
}

}  // namespace eigenlight
