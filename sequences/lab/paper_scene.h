// Frames of a built-in scene for paper reruns, and errors of pictures.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "frame/memory_source.h"
#include "render/live_source.h"
#include "sequences/runs/flythrough.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Seeds of references; no noisy frame has them.
inline constexpr std::uint32_t kPaperReferenceA = 1u << 30, kPaperReferenceB = (1u << 30) + 1;

/// A built-in scene over time.
class PaperScene {
 public:
  /// kAtRest: the camera keeps its first view, while lights and objects move on.
  enum class View { kAtRest, kFlight };
  PaperScene(std::string_view name, Perturbation perturbation, Extent extent,
             View view = View::kAtRest);
  ~PaperScene();
  PaperScene(const PaperScene&) = delete;
  PaperScene& operator=(const PaperScene&) = delete;

  /// Frames with 3 bounces and one sample of direct light per pixel, which no filter reads.
  [[nodiscard]] std::vector<Frame> render(int spp, const std::vector<int>& frames,
                                          std::uint32_t seed = 0) const;
  /// A source of frames with other options; options.extent is replaced by that of the scene.
  [[nodiscard]] LiveSource source(RenderOptions options, const std::vector<int>& frames) const;
  /// A source of the frames of render().
  [[nodiscard]] LiveSource source(int spp, const std::vector<int>& frames,
                                  std::uint32_t seed = 0) const;
  /// exposure * albedo * light, linear and not clamped; 0 without surface.
  [[nodiscard]] Planes<3> shown(const Frame& frame, const Planes<3>& light) const;
  [[nodiscard]] float exposure() const { return scene_.exposure; }

 private:
  Scene scene_;
  Extent extent_;
  std::unique_ptr<Animation> flight_;
  std::unique_ptr<Animation> rest_;  // flight_ from its first view; null for kFlight
};

/// The output of a method for each frame, through PaperScene::shown().
[[nodiscard]] std::vector<Planes<3>> run_method(const PaperScene& scene, Denoiser& method,
                                                const std::vector<Frame>& frames);

/// Mean of (x - a)(x - b) over channels and pixels with `mask` not 0. With independent references a
/// and b their noise cancels; with a = b it is the mean squared difference. 0 for an empty mask.
[[nodiscard]] double mean_square(const Planes<3>& x, const Planes<3>& a, const Planes<3>& b,
                                 const Plane<std::uint32_t>& mask);

}  // namespace eigenlight
