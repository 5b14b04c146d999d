// Error of each filter of single frames for the settings that spatial/README.md lists.
//
//   filter_tuning SCENE REFERENCE_SPP SPP...    a built-in scene, 480x270
//
// Prints one Markdown row a setting, and in it for each number of samples MSE and relMSE of
// albedo * indirect over the pixels with a surface, against two independent references, so that
// their noise drops out. Means over two frames of the flythrough; the first row is the noisy input.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "render/builtin/builtin_scenes.h"
#include "render/live_source.h"
#include "sequences/metrics/metrics.h"
#include "sequences/runs/flythrough.h"
#include "spatial/rivals/atrous_filter.h"
#include "spatial/rivals/cross_bilateral.h"
#include "spatial/rivals/guided_spatial.h"

namespace eigenlight {
namespace {

constexpr Extent kSize{480, 270};
const std::vector<int> kFrames{12, 36};

struct Setting {
  std::string name;
  std::function<std::unique_ptr<SpatialFilter>()> make;
};

template <typename Filter, typename Options>
void add(std::vector<Setting>& settings, const std::string& name, const Options& options) {
  settings.push_back({name, [options] { return std::make_unique<Filter>(kSize, options); }});
}

void add_cross_bilateral(std::vector<Setting>& list) {
  const auto vary = [&](const char* name, float CrossBilateralOptions::*field,
                        const std::vector<float>& values) {
    for (const float value : values) {
      CrossBilateralOptions options;
      options.*field = value;
      add<CrossBilateral>(list, fmt::format("cross-bilateral {} {}", name, value), options);
    }
  };
  for (const int radius : {8, 16, 24, 32}) {
    add<CrossBilateral>(list, fmt::format("cross-bilateral radius {}", radius),
                        CrossBilateralOptions{.radius = radius});
  }
  vary("sigma_normal", &CrossBilateralOptions::sigma_normal, {0.2f, 0.4f, 0.8f});
  vary("sigma_plane", &CrossBilateralOptions::sigma_plane, {0.005f, 0.02f, 0.08f});
  vary("sigma_albedo", &CrossBilateralOptions::sigma_albedo, {0.2f, 0.5f, 10.0f});
}

void add_atrous(std::vector<Setting>& list) {
  const auto vary = [&](const char* name, float AtrousFilterOptions::*field,
                        const std::vector<float>& values) {
    for (const float value : values) {
      AtrousFilterOptions options;
      options.*field = value;
      add<AtrousFilter>(list, fmt::format("atrous {} {}", name, value), options);
    }
  };
  for (const int passes : {3, 4, 6}) {
    add<AtrousFilter>(list, fmt::format("atrous passes {}", passes),
                      AtrousFilterOptions{.passes = passes});
  }
  vary("sigma_color", &AtrousFilterOptions::sigma_color, {16.0f, 64.0f, 1024.0f, 1e6f});
  vary("sigma_normal", &AtrousFilterOptions::sigma_normal, {0.1f, 0.2f, 0.4f});
  vary("sigma_position", &AtrousFilterOptions::sigma_position, {0.02f, 0.06f, 0.2f});
}

void add_guided(std::vector<Setting>& list) {
  const auto add_one = [&](const std::string& name, auto set) {
    GuidedOptions options = guided_alone();
    set(options);
    add<GuidedSpatial>(list, "guided " + name, options);
  };
  for (const int radius : {4, 6, 8, 12, 24}) {
    add_one(fmt::format("radius {}", radius), [=](GuidedOptions& o) { o.radius = radius; });
  }
  for (const Guides guides : {Guides::kGrayNormal, Guides::kNormal, Guides::kNormalDepth}) {
    add_one(fmt::format("guides {}", static_cast<int>(guides)),
            [=](GuidedOptions& o) { o.guides = guides; });
  }
  for (const float epsilon : {0.0025f, 0.01f, 0.04f}) {
    add_one(fmt::format("epsilon_normal {}", epsilon),
            [=](GuidedOptions& o) { o.epsilon_normal = epsilon; });
  }
  for (const float epsilon : {0.0002f, 0.0005f, 0.002f, 0.02f}) {
    add_one(fmt::format("epsilon_depth {}", epsilon),
            [=](GuidedOptions& o) { o.epsilon_depth = epsilon; });
  }
}

void shade(const Planes<3>& light, const GBuffer& surface, Planes<3>& out) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        out[c](x, y) = light[c](x, y) * surface.albedo[c](x, y);
      }
    }
  }
}

class Stage {
 public:
  explicit Stage(std::string_view name)
      : scene_(make_builtin_scene(name)),
        animation_(make_flythrough(scene_, Perturbation::kNone, kSize)) {}

  /// The frames at some samples a pixel; sequences of different seeds are independent.
  [[nodiscard]] std::vector<Frame> shoot(int spp, std::uint32_t seed) const {
    LiveSource source(scene_, *animation_,
                      {.extent = kSize, .spp = spp, .direct_spp = 1, .seed = seed}, kFrames);
    std::vector<Frame> frames(kFrames.size());
    for (Frame& frame : frames) {
      if (!source.next(frame)) throw std::runtime_error("the scene has too few frames");
    }
    return frames;
  }

 private:
  Scene scene_;
  std::unique_ptr<Animation> animation_;
};

using Shots = std::vector<Frame>;

/// Mean figures of a filter; of the noisy frames themselves where it is null.
Figures measure(const Shots& noisy, const std::array<Shots, 2>& references, SpatialFilter* filter) {
  SequenceMetrics metrics({});
  std::vector<FrameFigures> figures;
  Planes<3> out = make_planes<3>(kSize);
  Plane<float> weight(kSize);
  weight.fill(1.0f);
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const GBuffer& surface = noisy[i].surface;
    if (filter != nullptr) filter->process({noisy[i], noisy[i].lights[0].radiance, weight}, out);
    MetricFrame frame{.test = make_planes<3>(kSize),
                      .reference = make_planes<3>(kSize),
                      .reference_b = make_planes<3>(kSize),
                      .bits = Plane<std::uint8_t>(kSize)};
    shade(filter != nullptr ? out : noisy[i].lights[0].radiance, surface, frame.test);
    shade(references[0][i].lights[0].radiance, surface, frame.reference);
    shade(references[1][i].lights[0].radiance, surface, frame.reference_b);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        frame.bits(x, y) = surface.id(x, y) != 0 ? kFiniteBit | kSurfaceBit : kFiniteBit;
      }
    }
    figures.push_back(metrics.add(std::move(frame)));
  }
  return mean_figures(figures)[static_cast<std::size_t>(PixelSet::kSurface)];
}

int number(const char* text) {
  int value = 0;
  const std::string_view all = text;
  const auto [end, error] = std::from_chars(all.data(), all.data() + all.size(), value);
  if (error != std::errc() || end != all.data() + all.size() || value < 1) {
    throw std::invalid_argument(fmt::format("samples '{}': expected a positive number", text));
  }
  return value;
}

void run(int count, char** words) {
  EL_CHECK(count >= 4, "usage: filter_tuning SCENE REFERENCE_SPP SPP...");
  const Stage stage(words[1]);
  const int reference_spp = number(words[2]);
  const std::array<Shots, 2> references{stage.shoot(reference_spp, 1),
                                        stage.shoot(reference_spp, 2)};
  std::vector<Shots> noisy;
  std::string head = fmt::format("| {} |", words[1]), line = "| --- |";
  for (int i = 3; i < count; ++i) {
    noisy.push_back(stage.shoot(number(words[i]), 3));
    head += fmt::format(" MSE, {0} spp | relMSE, {0} spp |", words[i]);
    line += " ---: | ---: |";
  }
  std::vector<Setting> settings{{"noisy", [] { return nullptr; }}};
  add_cross_bilateral(settings);
  add_atrous(settings);
  add_guided(settings);
  fmt::print("{}\n{}\n", head, line);
  for (const Setting& setting : settings) {
    const auto filter = setting.make();
    std::string row = fmt::format("| {} |", setting.name);
    for (const Shots& shots : noisy) {
      const Figures figures = measure(shots, references, filter.get());
      row += fmt::format(" {:.3g} | {:.3g} |", figures[Metric::kMse].value(),
                         figures[Metric::kRelmse].value());
    }
    fmt::print("{}\n", row);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace eigenlight

int main(int count, char** words) {
  try {
    eigenlight::run(count, words);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "filter_tuning: {}\n", error.what());
    return 1;
  }
}
