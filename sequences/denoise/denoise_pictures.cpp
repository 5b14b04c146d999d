#include "sequences/denoise/denoise_pictures.h"

#include <algorithm>
#include <utility>

#include "sequences/pages/auto_exposure.h"
#include "sequences/pages/split_gallery.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// The layers to show: the beauty first, for it is what people look at.
std::vector<FileLayer> shown_layers(const LayerPlan& plan) {
  std::vector<FileLayer> layers;
  const auto add = [&](const FileLayer& layer) {
    const bool is_there = std::any_of(layers.begin(), layers.end(), [&](const FileLayer& other) {
      return key_of(other) == key_of(layer);
    });
    if (!is_there) layers.push_back(layer);
  };
  for (const ViewPlan& view : plan.views) {
    if (view.beauty) add(*view.beauty);
    for (const PlannedLight& light : view.lights) {
      if (light.layer) add(*light.layer);
    }
  }
  return layers;
}

// Red, green and blue of a layer, where the canvas has pixels of the file; gray has one for all.
Planes<3> on_canvas(const ExrFile& file, const fs::path& path, const FileLayer& layer,
                    const ExrWindow& canvas) {
  std::vector<int> channels = channel_indices(file, path.string(), layer);
  channels.resize(channels.size() < 3 ? 1 : 3);
  const std::vector<Plane<float>> read = file.read(channels);
  Planes<3> out = make_planes<3>({canvas.width, canvas.height});
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t from = std::min(c, read.size() - 1);
    const int part = file.channels()[static_cast<std::size_t>(channels[from])].part;
    const ExrWindow& window = file.parts()[static_cast<std::size_t>(part)].data;
    for (int y = 0; y < canvas.height; ++y) {
      for (int x = 0; x < canvas.width; ++x) {
        const int fx = x + canvas.x - window.x, fy = y + canvas.y - window.y;
        if (fx < 0 || fy < 0 || fx >= window.width || fy >= window.height) continue;
        out[c](x, y) = read[from](fx, fy);
      }
    }
  }
  return out;
}

// Pictures of one frame of inputs, or of outputs.
void read_views(const std::vector<fs::path>& paths, const std::vector<FileLayer>& layers,
                const ExrWindow& canvas, bool is_denoised, std::vector<SplitView>& views) {
  for (std::size_t input = 0; input < paths.size(); ++input) {
    const ExrFile file(paths[input]);
    for (std::size_t kind = 0; kind < layers.size(); ++kind) {
      if (layers[kind].input != static_cast<int>(input)) continue;
      views.push_back({kind, is_denoised, on_canvas(file, paths[input], layers[kind], canvas)});
    }
  }
}

float exposure_of(const DenoisePlan& plan, const FileLayer& layer) {
  const fs::path& path = plan.frames.front().outputs[static_cast<std::size_t>(layer.input)];
  return auto_exposure(on_canvas(ExrFile(path), path, layer, plan.canvas));
}

}  // namespace

PageGallery denoise_pictures(const DenoisePlan& plan) {
  const std::vector<FileLayer> layers = shown_layers(plan.layers);
  SplitPictures pictures;
  for (const FileLayer& layer : layers) pictures.kinds.push_back(name_for_people(layer));
  pictures.read = [&](int frame) {
    const auto files = std::find_if(plan.frames.begin(), plan.frames.end(),
                                    [&](const FrameFiles& f) { return f.frame == frame; });
    std::vector<SplitView> views;
    read_views(files->inputs, layers, plan.canvas, false, views);
    read_views(files->outputs, layers, plan.canvas, true, views);
    return views;
  };
  std::vector<int> frames;
  for (const FrameFiles& files : plan.frames) frames.push_back(files.frame);
  PictureOptions options;
  options.method = "eigenlight";
  options.exposure = exposure_of(plan, layers.front());
  return split_gallery(frames, pictures, options);
}

}  // namespace eigenlight
