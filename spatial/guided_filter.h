// Guided filter: light as a local linear function of normal and depth.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "frame/frame.h"
#include "frame/tiles.h"

namespace eigenlight {

/// What guides: Bauszat et al. 2011, Fig. 5 (a), (b) and (c).
enum class Guides {
  kGrayNormal = 1,   ///< the luminance of the normal taken as a color
  kNormal = 3,       ///< its three components
  kNormalDepth = 4,  ///< those and the logarithm of the depth
};

struct GuidedOptions {
  int radius = 8;  ///< [1, 32] pixels; a window has 2 radius + 1 on a side
  Guides guides = Guides::kNormalDepth;
  /// [1e-4, 1] variance of a normal's component below which it is no edge: Bauszat 2011 takes 0.01.
  float epsilon_normal = 0.01f;
  /// [1e-4, 1] variance of log(depth) below which it is no edge: Bauszat 2011 takes 0.01 to 0.03 of
  /// a scaled depth.
  float epsilon_depth = 0.02f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct GuidedInputs {
  const FrameInput& guides;  ///< normals, depth and id
  const Planes<3>& signal;
  const Plane<float>& weight;         ///< >= 0, say age; 0: the pixel's signal is not to be used
  const Plane<std::uint8_t>& wanted;  ///< not 0 where an output is needed
};

struct GuidedScratch;

/// He, Sun and Tang 2010, guided by noise-free geometry as in Bauszat et al. 2011 (Eq. 6-9), with
/// weights. With the guides I, at most (normal, log depth), each window k and channel N of the
/// signal has
///   min over a, b of  E_k[(a . I + b - N)^2] + epsilon . a^2,   E_k[f] = sum w f / sum w,
/// hence a = (Cov_k(I) + diag(epsilon))^-1 Cov_k(I, N) and b = E_k[N] - a . E_k[I]. At pixel p the
/// windows around all surface pixels k within `radius` are averaged: out(p) = mean(a_k) . I_p +
/// mean(b_k). The logarithm makes the depth dimensionless and the same for every window.
///
/// A pixel's signal counts where it is finite and its weight positive and finite. All other pixels
/// add to no sum, but their geometry gives them an output, too. Surfaces are those of
/// is_usable_surface() (frame/usable_surface.h). Output is 0 without surface and where no window
/// holds a usable signal. It is linear in the signal and may thus leave its range, below 0 as well.
///
/// A sum adds the values of its own window only: rounding errors do not accumulate, and a firefly
/// leaves no trace. Eight neighboring windows are summed at a time, first down, then along. The
/// rows or columns that all eight share are added once, from kept sums of eight: only that part
/// grows with the radius, by one addition for eight windows and 4 pixels of radius.
class GuidedFilter {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  GuidedFilter(Extent extent, const GuidedOptions& options);
  ~GuidedFilter();

  /// Writes all pixels of each 64 x 64 tile that has a wanted pixel to `out`; the others keep what
  /// they hold. Returns the number of pixels in tiles left out. Throws std::invalid_argument if
  /// extents differ or `out` is the signal itself.
  std::int64_t process(const GuidedInputs& in, Planes<3>& out);

 private:
  void plan_runs(const Plane<std::uint8_t>& wanted);
  void add_run(const Tile& run, std::size_t first);
  [[nodiscard]] std::unique_ptr<GuidedScratch> take_scratch();
  void give_back(std::unique_ptr<GuidedScratch> scratch);

  GuidedOptions options_;
  TileGrid grid_;
  PerTile<std::uint8_t> wanted_;
  std::vector<Tile> runs_;  // of tiles that are filtered in one go
  std::mutex mutex_;
  std::vector<std::unique_ptr<GuidedScratch>> spare_;  // one for each thread that has been here
};

}  // namespace eigenlight
