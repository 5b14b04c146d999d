#include "sequences/compare/recorded_method.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "frame/memory_source.h"
#include "sequences/compare/compare_run.h"
#include "sequences/exr/exr_rewrite.h"
#include "temporal/methods.h"
#include "temporal/stage_clock.h"

namespace eigenlight {

namespace fs = std::filesystem;

RecordedMethod::RecordedMethod(const std::string& method, const DenoisePlan& plan) : plan_(plan) {
  for (std::size_t v = 0; v < plan.layers.views.size(); ++v) {
    const ViewPlan& view = plan.layers.views[v];
    views_.push_back({{view, plan.readings[v], plan.canvas, plan.cuts}, {}, {}});
    for (std::size_t i = 0; i < view.lights.size(); ++i) {
      views_.back().denoisers.push_back(
          make_denoiser(method, {.extent = {plan.canvas.width, plan.canvas.height}}));
    }
  }
}

double RecordedMethod::step(const std::shared_ptr<const RawFrame>& raw) {
  raw_ = raw;
  double ms = 0.0;
  for (View& view : views_) {
    view.builder.build(raw, frame_);
    view.outputs.clear();
    std::vector<NoisyLight> lights = std::exchange(frame_.lights, std::vector<NoisyLight>(1));
    for (std::size_t i = 0; i < lights.size(); ++i) {
      std::swap(frame_.lights[0], lights[i]);
      copy_frame(frame_, single_);
      std::swap(frame_.lights[0], lights[i]);
      OneFrameSource source(single_);
      Denoiser& denoiser = *view.denoisers[i];
      view.outputs.push_back(denoiser.step(source));
      if (!view.outputs.back()) throw std::logic_error("a frame was lost");
      ms += denoise_cpu_ms(denoiser.report());
    }
    frame_.lights = std::move(lights);
  }
  return ms;
}

std::vector<std::vector<NewChannel>> RecordedMethod::compose() const {
  std::vector<std::vector<NewChannel>> channels(raw_->files.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    compose_view(*raw_, plan_.layers.views[v], plan_.canvas, views_[v].outputs, {}, channels);
  }
  return channels;
}

std::vector<fs::path> write_channels(const RawFrame& raw, const FrameFiles& files,
                                     const std::vector<std::vector<NewChannel>>& channels,
                                     const fs::path& folder) {
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < files.inputs.size(); ++i) {
    if (channels[i].empty()) {
      paths.push_back(files.inputs[i]);
      continue;
    }
    paths.push_back(folder / fmt::format("{}-{}", i, files.inputs[i].filename().string()));
    rewrite_exr(*raw.files[i], paths.back(), replacements_of(channels[i]));
  }
  return paths;
}

double files_cpu_ms(const DenoisePlan& plan, const std::vector<int>& frames,
                    const fs::path& folder) {
  constexpr int kMost = 3;
  double ms = 0.0;
  int count = 0;
  Frame frame;
  for (const FrameFiles& files : plan.frames) {
    if (count == kMost || !std::binary_search(frames.begin(), frames.end(), files.frame)) continue;
    StageClock clock;
    const auto raw =
        std::make_shared<const RawFrame>(read_raw_frame(files, plan.layers, plan.canvas));
    std::vector<std::vector<NewChannel>> channels(files.inputs.size());
    for (std::size_t v = 0; v < plan.layers.views.size(); ++v) {
      const ViewPlan& view = plan.layers.views[v];
      FrameBuilder(view, plan.readings[v], plan.canvas, plan.cuts).build(raw, frame);
      std::vector<const Planes<3>*> noisy;
      for (const NoisyLight& light : frame.lights) noisy.push_back(&light.radiance);
      compose_view(*raw, view, plan.canvas, noisy, {}, channels);
    }
    (void)write_channels(*raw, files, channels, folder);
    ms += clock.lap().cpu_ms;
    ++count;
  }
  return ms / std::max(count, 1);
}

}  // namespace eigenlight
