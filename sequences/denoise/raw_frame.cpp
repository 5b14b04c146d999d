#include "sequences/denoise/raw_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "frame/bad_file.h"

namespace eigenlight {
namespace {

// All layers of floats that a view reads.
std::vector<const FileLayer*> layers_of(const ViewPlan& view) {
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

ExrWindow united(const ExrWindow& a, const ExrWindow& b) {
  if (a.width == 0) return b;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  const int x1 = std::max(a.x + a.width, b.x + b.width);
  const int y1 = std::max(a.y + a.height, b.y + b.height);
  return {x, y, x1 - x, y1 - y};
}

// Copies what lies on the canvas.
template <typename T>
Plane<T> place(const Plane<T>& from, const ExrWindow& window, const ExrWindow& canvas) {
  Plane<T> to({canvas.width, canvas.height});
  const int dx = window.x - canvas.x, dy = window.y - canvas.y;
  const int x0 = std::max(dx, 0), x1 = std::min(dx + window.width, canvas.width);
  const int y0 = std::max(dy, 0), y1 = std::min(dy + window.height, canvas.height);
  for (int y = y0; y < y1 && x0 < x1; ++y) {
    std::copy_n(from.at(x0 - dx, y - dy), x1 - x0, to.at(x0, y));
  }
  return to;
}

const ExrWindow& window_of(const ExrFile& file, int channel) {
  const int part = file.channels()[static_cast<std::size_t>(channel)].part;
  return file.parts()[static_cast<std::size_t>(part)].data;
}

// All layers of one input at once: a file is decoded as whole parts.
void read_input(const ExrFile& file, const std::string& path, int input,
                const std::vector<const FileLayer*>& layers, const ExrWindow& canvas,
                RawFrame& frame) {
  std::vector<int> wanted;
  std::vector<std::pair<std::string, std::size_t>> owners;  // key, number of channels
  for (const FileLayer* layer : layers) {
    if (layer->input != input || frame.planes.count(key_of(*layer)) > 0) continue;
    const std::vector<int> found = channel_indices(file, path, *layer);
    wanted.insert(wanted.end(), found.begin(), found.end());
    owners.emplace_back(key_of(*layer), found.size());
    frame.planes.emplace(key_of(*layer), LayerPlanes());
  }
  if (wanted.empty()) return;
  const std::vector<Plane<float>> planes = file.read(wanted);
  std::size_t next = 0;
  for (const auto& [key, count] : owners) {
    for (std::size_t c = 0; c < count; ++c, ++next) {
      frame.planes[key].push_back(place(planes[next], window_of(file, wanted[next]), canvas));
    }
  }
}

void read_id(const ViewPlan& view, const ExrWindow& canvas, const std::vector<std::string>& paths,
             RawFrame& frame) {
  if (!view.id) return;
  const auto input = static_cast<std::size_t>(view.id->input);
  const ExrFile& file = *frame.files[input];
  const int channel = channel_indices(file, paths[input], *view.id).front();
  Plane<std::uint32_t> id;
  if (file.channels()[static_cast<std::size_t>(channel)].type == ExrType::kUint) {
    id = file.read_uint(channel);
  } else {
    const int wanted[] = {channel};
    const Plane<float> values = std::move(file.read(wanted).front());
    id = Plane<std::uint32_t>(values.extent());
    for (int y = 0; y < id.height(); ++y) {
      for (int x = 0; x < id.width(); ++x) {
        const float value = values(x, y);
        // Ids of hashes are negative or huge: any value that tells objects apart will do.
        id(x, y) = value >= 0.0f && value < 4e9f ? static_cast<std::uint32_t>(value) : 1u;
      }
    }
  }
  frame.ids[view.view] = place(id, window_of(file, channel), canvas);
}

}  // namespace

std::string key_of(const FileLayer& layer) {
  return fmt::format("{}:{}:{}", layer.input, layer.view, layer.name);
}

const LayerPlanes& RawFrame::at(const FileLayer& layer) const {
  const auto found = planes.find(key_of(layer));
  if (found == planes.end()) throw std::logic_error("a layer that was not read: " + layer.name);
  return found->second;
}

std::vector<int> channel_indices(const ExrFile& file, const std::string& path,
                                 const FileLayer& layer) {
  std::vector<int> indices;
  for (const std::string& name : layer.channels) {
    const auto& channels = file.channels();
    const auto found = std::find_if(channels.begin(), channels.end(), [&](const auto& channel) {
      return channel.full_name == name && channel.view == layer.view;
    });
    if (found == channels.end()) {
      throw BadFile(fmt::format("{}: no channel '{}', which the first frame has", path, name));
    }
    indices.push_back(static_cast<int>(found - channels.begin()));
  }
  return indices;
}

ExrWindow find_canvas(const std::vector<FrameFiles>& frames, const LayerPlan& plan) {
  ExrWindow canvas{0, 0, 0, 0};
  for (const FrameFiles& frame : frames) {
    for (const ViewPlan& view : plan.views) {
      const FileLayer& light = first_light(view);
      const auto& path = frame.inputs[static_cast<std::size_t>(light.input)];
      const ExrFile file(path);
      canvas = united(canvas, window_of(file, channel_indices(file, path.string(), light).front()));
    }
  }
  return canvas;
}

RawFrame read_raw_frame(const FrameFiles& paths, const LayerPlan& plan, const ExrWindow& canvas) {
  RawFrame frame;
  frame.frame = paths.frame;
  std::vector<std::string> names;
  for (const auto& path : paths.inputs) {
    frame.files.push_back(std::make_shared<const ExrFile>(path));
    names.push_back(path.string());
  }
  for (const ViewPlan& view : plan.views) {
    const std::vector<const FileLayer*> layers = layers_of(view);
    for (std::size_t input = 0; input < names.size(); ++input) {
      read_input(*frame.files[input], names[input], static_cast<int>(input), layers, canvas, frame);
    }
    read_id(view, canvas, names, frame);
    const FileLayer& light = first_light(view);
    const auto input = static_cast<std::size_t>(light.input);
    const ExrFile& file = *frame.files[input];
    frame.present[view.view] = window_of(file, channel_indices(file, names[input], light).front());
  }
  return frame;
}

}  // namespace eigenlight
