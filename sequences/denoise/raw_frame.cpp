#include "sequences/denoise/raw_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "frame/bad_file.h"

namespace eigenlight {
namespace {

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
  std::vector<int> wanted;                                       // each channel once
  std::vector<std::pair<std::string, std::vector<int>>> owners;  // key, channels
  for (const FileLayer* layer : layers) {
    if (layer->input != input || frame.planes.count(key_of(*layer)) > 0) continue;
    const std::vector<int> found = channel_indices(file, path, *layer);
    for (const int channel : found) {
      if (std::find(wanted.begin(), wanted.end(), channel) == wanted.end()) {
        wanted.push_back(channel);
      }
    }
    owners.emplace_back(key_of(*layer), found);
    frame.planes.emplace(key_of(*layer), LayerPlanes());
  }
  if (wanted.empty()) return;
  const std::vector<Plane<float>> planes = file.read(wanted);
  for (const auto& [key, channels] : owners) {
    for (const int channel : channels) {
      const auto place_of = std::find(wanted.begin(), wanted.end(), channel) - wanted.begin();
      frame.planes[key].push_back(
          place(planes[static_cast<std::size_t>(place_of)], window_of(file, channel), canvas));
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
  return channel_indices(file.channels(), path, layer);
}

Planes<3> view_layer(const LayerPlanes& layer) {
  Planes<3> views;
  for (std::size_t c = 0; c < 3; ++c) {
    const Plane<float>& plane = layer[layer.size() < 3 ? 0 : c];
    const auto apart = static_cast<std::ptrdiff_t>(plane.stride() * sizeof(float));
    views[c] = Plane<float>::view(plane.row(0), plane.extent(), apart);
  }
  return views;
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
    const std::vector<const FileLayer*> layers = layers_read(view);
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
