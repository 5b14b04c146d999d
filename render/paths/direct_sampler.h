// Direct light of the guide rays of a frame, in two parts.
#pragma once

#include <cstdint>

#include "frame/tiles.h"
#include "render/paths/gbuffer.h"
#include "render/paths/path_tracer.h"
#include "render/paths/sample_mean.h"

namespace eigenlight {

struct DirectSamples {
  int spp = 0;           ///< of each part; 0: direct light is black
  int met_spp = 0;       ///< samples of met light that add_met() brings before sample()
  int penumbra_spp = 0;  ///< samples of the sun in penumbras; not above spp: no more than elsewhere
};

/// Samples direct light. A sun is either seen or hidden but in its penumbra: where all samples of
/// the other pixels of 5 x 5 around are lit, or none is, a few say all; elsewhere further ones are
/// drawn. A pixel's own samples do not take part in that decision: it would depend on what they
/// say, and penumbras would become steeper.
///
/// Tiles can be sampled in any order and at the same time. Bits depend on keys alone.
class DirectSampler {
 public:
  /// `tracer` must outlive this.
  DirectSampler(const PathTracer& tracer, Extent extent, const DirectSamples& samples);

  /// Adds the mean of `count` samples of met light at a pixel to those of the frame so far,
  /// `before` in number.
  void add_met(glm::ivec2 at, const glm::vec3& mean, std::uint32_t count, std::uint32_t before);
  /// First samples of a tile, after met_spp of met light. `key(at)` names the random numbers of a
  /// pixel. Writes 0 where there is no surface.
  template <typename Key>
  void sample(const Tile& tile, const Plane<GuideHit>& hits, const Key& key, RayCounters& tally) {
    for_pixels(tile, [&](glm::ivec2 at) { sample(at, hits(at.x, at.y), key(at), tally); });
  }
  /// Further samples in penumbras, after all tiles had their first ones, and the sum of both parts.
  template <typename Key>
  void refine(const Tile& tile, const Plane<GuideHit>& hits, const Key& key, Planes<3>& direct,
              RayCounters& tally) {
    for_pixels(tile, [&](glm::ivec2 at) {
      if (is_penumbra(at)) refine(at, hits(at.x, at.y), key(at), tally);
      store_pixel(load_pixel(sun_, at.x, at.y) + load_pixel(soft_, at.x, at.y), at.x, at.y, direct);
    });
  }
  /// All samples of the frame are drawn but those that add_met() brings from now on.
  void finish();
  /// Forgets what add_met() brought since finish().
  void rewind();

  [[nodiscard]] const Planes<3>& sun() const { return sun_; }
  [[nodiscard]] const Planes<3>& soft() const { return soft_; }

 private:
  template <typename Pixel>
  static void for_pixels(const Tile& tile, const Pixel& pixel) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) pixel(glm::ivec2(x, y));
    }
  }
  void sample(glm::ivec2 at, const GuideHit& hit, std::uint32_t key, RayCounters& tally);
  void refine(glm::ivec2 at, const GuideHit& hit, std::uint32_t key, RayCounters& tally);
  [[nodiscard]] bool is_penumbra(glm::ivec2 at) const;

  const PathTracer& tracer_;
  DirectSamples samples_;
  Planes<3> sun_, met_, soft_, first_met_, first_soft_;
  Plane<std::uint8_t> seen_;  // of the samples of the sun: bit 0, one is lit; bit 1, one is not
};

}  // namespace eigenlight
