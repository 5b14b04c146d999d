#include "sequences/lab/paper_scene.h"

#include "render/builtin/builtin_scenes.h"
#include "sequences/files/compose.h"

namespace eigenlight {
namespace {

class CameraAtRest final : public Animation {
 public:
  explicit CameraAtRest(const Animation& flight)
      : flight_(flight), camera_(flight.state(0).camera) {}
  [[nodiscard]] SceneState state(int frame) const override {
    SceneState state = flight_.state(frame);
    state.camera = camera_;
    return state;
  }

 private:
  const Animation& flight_;
  Camera camera_;
};

}  // namespace

PaperScene::PaperScene(std::string_view name, Perturbation perturbation, Extent extent, View view)
    : scene_(make_builtin_scene(name)),
      extent_(extent),
      flight_(make_flythrough(scene_, perturbation, extent)) {
  if (view == View::kAtRest) rest_ = std::make_unique<CameraAtRest>(*flight_);
}

PaperScene::~PaperScene() = default;

LiveSource PaperScene::source(RenderOptions options, const std::vector<int>& frames) const {
  options.extent = extent_;
  return {scene_, rest_ ? *rest_ : *flight_, options, frames};
}

LiveSource PaperScene::source(int spp, const std::vector<int>& frames, std::uint32_t seed) const {
  return source({.spp = spp, .direct_spp = 1, .seed = seed}, frames);
}

std::vector<Frame> PaperScene::render(int spp, const std::vector<int>& frames,
                                      std::uint32_t seed) const {
  LiveSource live = source(spp, frames, seed);
  std::vector<Frame> rendered(frames.size());
  for (Frame& frame : rendered) {
    if (!live.next(frame)) throw std::logic_error("a source ends before its last frame");
  }
  return rendered;
}

Planes<3> PaperScene::shown(const Frame& frame, const Planes<3>& light) const {
  Planes<3> out;
  modulate(frame.surface.albedo, light, out);
  for (Plane<float>& plane : out) {
    for (float& value : plane.storage()) value *= scene_.exposure;
  }
  return out;
}

std::vector<Planes<3>> run_method(const PaperScene& scene, Denoiser& method,
                                  const std::vector<Frame>& frames) {
  MemorySource source(frames);
  std::vector<Planes<3>> pictures;
  while (const Planes<3>* light = method.step(source)) {
    pictures.push_back(scene.shown(method.frame(), *light));
  }
  return pictures;
}

double mean_square(const Planes<3>& x, const Planes<3>& a, const Planes<3>& b,
                   const Plane<std::uint32_t>& mask) {
  double sum = 0.0;
  std::int64_t count = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int i = 0; i < mask.width(); ++i) {
      if (mask(i, y) == 0) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(x[c](i, y));
        sum +=
            (value - static_cast<double>(a[c](i, y))) * (value - static_cast<double>(b[c](i, y)));
      }
      count += 3;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace eigenlight
