// Frames of a built-in scene, and how far pictures of them are from the truth.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "frame/memory_source.h"
#include "render/live_source.h"
#include "sequences/runs/flythrough.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Seeds of references, which no noisy frame has.
inline constexpr std::uint32_t kPaperReferenceA = 1u << 30, kPaperReferenceB = (1u << 30) + 1;

/// A built-in scene over time.
class PaperScene {
 public:
  /// kAtRest: from its first view for ever, while lights and objects go on.
  enum class View { kAtRest, kFlight };
  PaperScene(std::string_view name, Perturbation perturbation, Extent extent,
             View view = View::kAtRest);
  ~PaperScene();
  PaperScene(const PaperScene&) = delete;
  PaperScene& operator=(const PaperScene&) = delete;

  /// One direct sample a pixel, which no filter reads, and 3 bounces.
  [[nodiscard]] std::vector<Frame> render(int spp, const std::vector<int>& frames,
                                          std::uint32_t seed = 0) const;
  /// A source of frames that are rendered in another way; options.extent is the scene's.
  [[nodiscard]] LiveSource source(RenderOptions options, const std::vector<int>& frames) const;
  /// A source of the same frames.
  [[nodiscard]] LiveSource source(int spp, const std::vector<int>& frames,
                                  std::uint32_t seed = 0) const;
  /// exposure * albedo * light: what is shown, linear and not clamped. 0 without surface.
  [[nodiscard]] Planes<3> shown(const Frame& frame, const Planes<3>& light) const;
  [[nodiscard]] float exposure() const { return scene_.exposure; }

 private:
  Scene scene_;
  Extent extent_;
  std::unique_ptr<Animation> flight_;
  std::unique_ptr<Animation> rest_;  // flight_ from its first view; null for kFlight
};

/// What a method makes of each frame, as shown.
[[nodiscard]] std::vector<Planes<3>> run_method(const PaperScene& scene, Denoiser& method,
                                                const std::vector<Frame>& frames);

/// Mean over pixels with `mask` not 0 and channels of (x - a)(x - b): with independent references
/// a and b free of their noise; with a = b the mean squared difference. 0 for an empty mask.
[[nodiscard]] double mean_square(const Planes<3>& x, const Planes<3>& a, const Planes<3>& b,
                                 const Plane<std::uint32_t>& mask);

}  // namespace eigenlight
