#include "render/antialias/picture.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "frame/check.h"
#include "frame/random.h"
#include "frame/tiles.h"
#include "render/antialias/lookup.h"
#include "render/antialias/reconstruct.h"
#include "render/paths/sample_queue.h"

namespace eigenlight {
namespace {

constexpr int kTileSide = 16;  // the same as in live_source.cpp

// Positions in a pixel whose upper left corner is (0, 0): a square grid turned by atan(1/2).
// Together with the pixel center, which the guide ray takes, each of the five has a fifth of the
// rows and of the columns.
constexpr std::array<glm::vec2, 4> kRotatedGrid{
    {{0.1f, 0.7f}, {0.3f, 0.1f}, {0.7f, 0.9f}, {0.9f, 0.3f}}};

// Samples of the sun at a point without a guide ray on its side of the shadow's edge.
constexpr std::uint32_t kSunSamples = 4;

// LiveSource draws its samples from streams 0 and 1.
constexpr std::uint32_t kPlaceStream = 2;
constexpr std::uint32_t kIndirectStream = 3;
constexpr std::uint32_t kDirectStream = 4;

struct Tally {
  RayCounters counters;
  std::int64_t unmatched = 0;
};

// The camera rays of one pixel.
class PixelRays {
 public:
  PixelRays(const PictureInputs& in, const Plane<std::uint8_t>& lit, glm::ivec2 at, Tally& tally)
      : in_(in), lit_(lit), at_(at), tally_(tally) {}

  [[nodiscard]] glm::vec3 color(const AntialiasOptions& options) {
    if (options.mode == AntialiasMode::kLookup) return looked_up();
    if (options.mode == AntialiasMode::kSraa || options.mode == AntialiasMode::kSraaGeometry) {
      return reconstructed(options.mode);
    }
    return supersampled(options.samples);
  }

 private:
  struct EyeRay {
    glm::vec2 pixel;
    std::uint32_t index;  // in the pixel
    EyeHit hit;
  };

  [[nodiscard]] EyeRay trace(glm::vec2 place, std::uint32_t index, float rays_per_pixel) {
    const Camera& camera = in_.guides.frame.camera;
    const glm::vec2 pixel = glm::vec2(at_) + place;
    const float spread = 1.0f / (camera.focal * std::sqrt(rays_per_pixel));
    ++tally_.counters.rays;
    return {pixel, index, trace_eye(in_.world, camera, pixel, spread)};
  }
  [[nodiscard]] static bool reflects(const EyeRay& ray) {
    return ray.hit.guide.kind == GuideHit::Kind::kSurface;
  }
  [[nodiscard]] static glm::vec3 color(const EyeRay& ray, const glm::vec3& light) {
    return ray.hit.albedo * light + ray.hit.emission;
  }
  [[nodiscard]] std::uint32_t key(std::uint32_t stream, std::uint32_t index) const {
    return hash_key(in_.seed, in_.guides.frame.index, at_.x, at_.y, stream, index);
  }
  [[nodiscard]] glm::vec3 direct(const EyeRay& ray, int samples);
  [[nodiscard]] glm::vec3 indirect(const EyeRay& ray);
  [[nodiscard]] glm::vec3 sun(const EyeRay& ray);
  [[nodiscard]] glm::vec3 looked_up();
  [[nodiscard]] glm::vec3 reconstructed(AntialiasMode mode);
  [[nodiscard]] glm::vec3 supersampled(int samples);
  // Mean color of the guide ray and the rotated grid; `light_at(ray)` gives the light at a surface.
  template <typename LightAt>
  [[nodiscard]] glm::vec3 mean_of_grid(const LightAt& light_at);

  const PictureInputs& in_;
  const Plane<std::uint8_t>& lit_;
  glm::ivec2 at_;
  Tally& tally_;
};

glm::vec3 PixelRays::direct(const EyeRay& ray, int samples) {
  FiniteMean mean;
  for (int i = 0; i < samples; ++i) {
    Sampler sampler(key(kDirectStream, ray.index), static_cast<std::uint32_t>(i));
    mean.add(in_.tracer.direct(ray.hit.guide.point, sampler, tally_.counters.rays),
             tally_.counters);
  }
  return mean.value();
}

glm::vec3 PixelRays::indirect(const EyeRay& ray) {
  FiniteMean mean;
  SampleQueue queue(in_.tracer, tally_.counters);
  for (int i = 0; i < in_.spp; ++i) {
    queue.add(ray.hit.guide.point, {key(kIndirectStream, ray.index), static_cast<std::uint32_t>(i)},
              mean);
  }
  queue.flush();
  return mean.value();
}

template <typename LightAt>
glm::vec3 PixelRays::mean_of_grid(const LightAt& light_at) {
  constexpr float kRays = static_cast<float>(kRotatedGrid.size() + 1);
  FiniteMean mean;
  mean.add(in_.guides.color(at_.x, at_.y), tally_.counters);
  for (std::uint32_t i = 0; i < kRotatedGrid.size(); ++i) {
    const EyeRay ray = trace(kRotatedGrid[i], i, kRays);
    mean.add(color(ray, reflects(ray) ? light_at(ray) : glm::vec3(0.0f)), tally_.counters);
  }
  return mean.value();
}

// Light of suns at an eye ray, without noise: that of a guide ray on its side of the shadow's edge.
glm::vec3 PixelRays::sun(const EyeRay& ray) {
  std::int64_t& rays = tally_.counters.rays;
  const std::uint8_t seen = in_.tracer.sees_sun(ray.hit.guide.point, rays) ? 1 : 0;
  const SeenAlike alike{lit_, seen};
  const auto guide =
      most_similar_guide(in_.guides, {ray.pixel, ray.hit.depth, ray.hit.normal}, &alike);
  if (guide) return load_pixel(*in_.sun, guide->x, guide->y);
  FiniteMean mean;
  for (std::uint32_t i = 0; i < kSunSamples; ++i) {
    Sampler sampler(key(kDirectStream, ray.index), i);
    mean.add(in_.tracer.sun_light(ray.hit.guide.point, sampler, rays), tally_.counters);
  }
  return mean.value();
}

glm::vec3 PixelRays::looked_up() {
  // Four rays with a quarter of the samples have at most the noise of the guide ray.
  const int samples = (in_.direct_spp + 3) / 4;
  return mean_of_grid([&](const EyeRay& ray) {
    const auto guide = most_similar_guide(in_.guides, {ray.pixel, ray.hit.depth, ray.hit.normal});
    if (!guide) ++tally_.unmatched;
    if (guide && in_.sun) {
      const glm::vec3 soft = load_pixel(in_.guides.direct, guide->x, guide->y) -
                             load_pixel(*in_.sun, guide->x, guide->y);
      return soft + sun(ray) + in_.guides.indirect_light(guide->x, guide->y);
    }
    return direct(ray, samples) +
           (guide ? in_.guides.indirect_light(guide->x, guide->y) : indirect(ray));
  });
}

glm::vec3 PixelRays::reconstructed(AntialiasMode mode) {
  return mean_of_grid([&](const EyeRay& ray) {
    const std::uint8_t lit = mode == AntialiasMode::kSraa
                                 ? in_.tracer.lit_by(ray.hit.guide.point, tally_.counters.rays)
                                 : std::uint8_t{0};
    const auto light =
        reconstruct_light(in_.guides, lit_, {ray.pixel, ray.hit.depth, ray.hit.normal}, lit);
    if (light) return *light;
    ++tally_.unmatched;
    return direct(ray, in_.direct_spp) + indirect(ray);
  });
}

glm::vec3 PixelRays::supersampled(int samples) {
  FiniteMean mean;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(samples); ++i) {
    Sampler places(key(kPlaceStream, 0), i);
    const EyeRay ray = trace(places.next_2d(), i, static_cast<float>(samples));
    const glm::vec3 light =
        reflects(ray) ? direct(ray, in_.direct_spp) + indirect(ray) : glm::vec3(0.0f);
    mean.add(color(ray, light), tally_.counters);
  }
  return mean.value();
}

// Stores PathTracer::lit_by() of all guide rays, or of suns alone; returns the number of rays
// traced.
std::int64_t judge_shadows(const PictureInputs& in, const TileGrid& grid, bool only_suns,
                           Plane<std::uint8_t>& lit) {
  std::vector<std::int64_t> rays(static_cast<std::size_t>(grid.count()));
  for_each_tile(grid, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        if (!in.guides.is_surface(x, y)) continue;
        const SurfacePoint& point = in.guides.hits(x, y).point;
        std::int64_t& count = rays[static_cast<std::size_t>(tile.index)];
        lit(x, y) = only_suns ? std::uint8_t{in.tracer.sees_sun(point, count)}
                              : in.tracer.lit_by(point, count);
      }
    }
  });
  std::int64_t sum = 0;
  for (const std::int64_t count : rays) sum += count;
  return sum;
}

void check(const AntialiasOptions& options, const GuideMap& guides) {
  const Extent extent = guides.frame.extent();
  EL_CHECK(guides.indirect[0].extent() == extent && guides.direct[0].extent() == extent &&
               guides.hits.extent() == extent,
           "light, guide rays and frame: expected one size");
  EL_CHECK(options.mode != AntialiasMode::kNone,
           "aa none: expected a mode that renders a picture of its own");
  const bool counts = options.mode == AntialiasMode::kSupersample;
  EL_CHECK(!counts || (options.samples >= 2 && options.samples <= kMaxSupersamples),
           "supersample: {} samples, expected 2 to {}", options.samples, kMaxSupersamples);
}

}  // namespace

PictureStats render_picture(const AntialiasOptions& options, const PictureInputs& in,
                            Planes<3>& out) {
  const Extent extent = in.guides.frame.extent();
  check(options, in.guides);
  ensure_extent(out, extent);
  const TileGrid grid(extent, kTileSide, kTileSide);
  PictureStats stats;
  Plane<std::uint8_t> lit(extent);
  const bool looks_up = options.mode == AntialiasMode::kLookup && in.sun;
  if (looks_up || options.mode == AntialiasMode::kSraa) {
    stats.rays += judge_shadows(in, grid, looks_up, lit);
  }
  std::vector<Tally> tallies(static_cast<std::size_t>(grid.count()));
  for_each_tile(grid, [&](const Tile& tile) {
    Tally& tally = tallies[static_cast<std::size_t>(tile.index)];
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        store_pixel(PixelRays(in, lit, {x, y}, tally).color(options), x, y, out);
      }
    }
  });
  for (const Tally& tally : tallies) {
    stats.rays += tally.counters.rays;
    stats.non_finite += tally.counters.non_finite;
    stats.unmatched += tally.unmatched;
  }
  return stats;
}

}  // namespace eigenlight
