// Edge-avoiding a-trous wavelet passes, steered by variance.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "spatial/planar_blocks.h"

namespace eigenlight {

struct AtrousOptions {
  int passes = 4;  ///< [1, 6]; pass i reaches 2^i pixels
  /// (0, 100] standard deviations of luminance that still count as the same light; +inf: light does
  /// not count, only geometry.
  float luminance_sigmas = 7.0f;
  /// Where an earlier picture is given, how far its luminance at a neighbor may be off that at the
  /// pixel: (0, 100] standard deviations of this picture, plus a share in [0, 1] of it.
  float earlier_sigmas = 1.5f, earlier_share = 0.1f;
  /// (0, 1] of the depth: distance off the pixel's plane that weighs a neighbor by 1/e.
  float plane_distance = 0.02f;
  bool skip_planar = true;  ///< no weights of geometry where all taps lie in one plane

  void validate() const;  ///< throws std::invalid_argument naming the field
  [[nodiscard]] bool looks_at_light() const { return !std::isinf(luminance_sigmas); }
  /// For PlanarBlocks, of the depth: a thousandth of plane_distance. A weight of exp(-2e-3) is as
  /// good as 1 to a denoiser, and rounding of depths is 1e-7 of them.
  [[nodiscard]] float planar_tolerance() const { return 1e-3f * plane_distance; }
};

/// An image and the variance of its luminance, both filtered in place.
struct AtrousImage {
  Planes<3>& color;
  Plane<float>& variance;
  const Plane<float>* earlier = nullptr;  ///< g below, or null
};

/// An image, and what is known of its pixels. `wanted`: not 0 in the tiles of stage_tiles() that
/// are filtered.
struct AtrousPart {
  const FrameInput& guides;
  const PerTile<std::uint8_t>& wanted;
  Planes<3>& color;
  Plane<float>& variance;
};

/// Dammertz et al. 2010 with the variance steering of Schied et al. 2017 (SVGF, section 4.4):
///   out(p) = sum_q h(q) w(p, q) c(q) / sum_q h(q) w(p, q),  q = p + 2^pass (-1 .. 1, -1 .. 1),
///   h 3 x 3 binomial weights instead of their 5 x 5 spline: a third of the cost,
///   w = max(0, N_p . N_q)^64 * e(|N_p . (X_q - X_p)| / (plane_distance * depth_p))
///                            * e(|l_q - l_p| / (luminance_sigmas * sigma_p + 1e-4 |l_p|)
///                              + |g_q - g_p| / (earlier_sigmas * sigma_p + earlier_share |g_p|))
/// where sigma_p^2 is the variance of luminance around p (3 x 3 Gaussian) and e(x) = (1 - x/8)^8,
/// close to exp(-x), ends at x = 8. g is the luminance of an earlier, filtered picture, warped to
/// the pixels of this one: with less noise it shows where light changes from one pixel to the next.
/// It is used for nothing else. Its term is 0 without an earlier picture, and where either g is
/// unknown (NaN). Variances follow: var(p) = sum (h w)^2 var(q) / (sum h w)^2. Pixels without
/// surface keep their value and give nothing to others. Pixels that have no depth, or whose normals
/// have a product above kLargestCosine, do not mix.
///
/// Where all taps lie in one plane (planar_blocks.h) the weights of geometry are 1 within 0.5 % and
/// are not calculated.
///
/// Several images of one frame are filtered in one visit, each by its own light: the weights of
/// geometry are calculated once for all of them. Tiles in which no variance of an image exceeds
/// `quiet` times the squared luminance are copied. Throws std::invalid_argument if extents differ.
class Atrous {
 public:
  static constexpr int kMostImages = 8;

  /// `images`: [1, kMostImages] that can be filtered at once.
  Atrous(Extent extent, const AtrousOptions& options, int images = 1);

  /// Filters 1 to `images` images. Returns the surface pixels that the first pass skips, over all
  /// images. Throws std::invalid_argument also if one image has an earlier picture and another has
  /// none.
  std::int64_t process(const FrameInput& guides, float quiet, std::span<const AtrousImage> images);
  /// The same for one image.
  std::int64_t process(const FrameInput& guides, float quiet, Planes<3>& color,
                       Plane<float>& variance, const Plane<float>* earlier = nullptr);

  /// Filters 1 to `images` images without earlier pictures in the tiles wanted of each; the others
  /// are copied. Their guides are those of one frame, but each may lack other pixels (depth +inf,
  /// id 0). Weights of geometry are calculated once for all images whose guides are the same around
  /// a tile; each image gets the same bits as alone.
  void process(std::span<const AtrousPart> parts);

  /// Bit i: the last process() of parts found the guides of image i around a tile to be those of
  /// image 0, and so took the same weights.
  [[nodiscard]] std::uint8_t joined(int tile) const { return joined_[tile]; }
  /// Pixels whose first pass calculated no weights of geometry, for the first image.
  [[nodiscard]] std::int64_t planar_pixels() const { return planar_.front().pixels(); }

 private:
  // Room for the outcome of a pass.
  struct Scratch {
    Planes<3> color;
    Plane<float> variance;
  };

  struct Job {
    const FrameInput& guides;
    const PlanarBlocks& planar;
    AtrousImage image;
  };

  void check(const FrameInput& guides, std::span<const AtrousImage> images) const;
  void check(std::span<const AtrousPart> parts) const;
  std::int64_t find_noisy(const FrameInput& guides, float quiet,
                          std::span<const AtrousImage> images);
  void forget_quiet(float quiet, std::span<const AtrousImage> images);
  void find_same(std::span<const AtrousPart> parts);
  [[nodiscard]] std::uint8_t same_around(int tile) const;
  void join(std::span<const AtrousPart> parts);
  void find_planes(const FrameInput& guides, const PerTile<std::uint8_t>& wanted,
                   std::size_t image);
  void run_images(int pass, std::span<const Job> jobs, const Tile& area, std::uint8_t images);
  void run_area(int pass, std::span<const Job> jobs, const Tile& area);
  void run_pass(int pass, std::span<const Job> jobs);

  AtrousOptions options_;
  TileGrid grid_;
  // Of each image; the first one's is that of all whose guides are the same everywhere.
  std::vector<PlanarBlocks> planar_;
  std::vector<Scratch> scratch_;  // of each image
  // Bit i stands for image i: it is filtered there; its guides are those of image 0 in the tile; so
  // are its weights of geometry.
  PerTile<std::uint8_t> wanted_, same_, joined_;
  std::uint8_t all_same_ = 0;      // bit i: the planes of image 0 are those of image i
  PerTile<std::int64_t> skipped_;  // surface pixels
};

}  // namespace eigenlight
