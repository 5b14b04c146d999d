// Light at a point of a surface: direct, and by bounces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "render/lights/light_set.h"
#include "render/paths/sampler.h"
#include "render/rays/embree_scene.h"
#include "render/rays/surface.h"

namespace eigenlight {

/// What rays travel through. All must outlive the tracer; poses and lights may change between
/// calls.
struct World {
  const EmbreeScene& geometry;
  const SurfaceTable& surfaces;
  const LightSet& lights;
};

/// Estimates, one sample a call, of the two parts of the light that a Lambertian surface reflects,
/// over its albedo: outgoing = albedo * (direct + indirect) + emission, where
///   direct   = 1/pi * integral of radiance that lights emit * cosine
///   indirect = 1/pi * integral of radiance that other surfaces reflect * cosine.
/// Both are unbiased but for paths of more than `bounces` bounces, which indirect leaves out.
/// Light is found by aiming at it and by cosine-distributed rays, combined by the power heuristic.
class PathTracer {
 public:
  /// `bounces` in [1, 64]: 1 is light that one other surface reflects.
  PathTracer(const World& world, int bounces) : world_(world), bounces_(bounces) {}

  /// May be NaN or Inf if the scene is. Adds the rays that were traced to `rays`.
  [[nodiscard]] glm::vec3 direct(const SurfacePoint& point, Sampler& sampler,
                                 std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 indirect(const SurfacePoint& point, const Sampler& sampler,
                                   std::int64_t& rays) const;

  /// Paths side by side: enough for a fetch from memory to arrive meanwhile, few enough for the
  /// first-level cache.
  static constexpr std::size_t kSideBySide = 32;

  struct Path;
  /// The same for many: each path's `light` is, bit for bit, what it would be alone. They go side
  /// by side, so that memory is fetched for some while others are computed.
  void indirect(std::span<Path> paths, std::int64_t& rays) const;

  /// Which lights shine on the point: bit 0 for a sun, bit 1 for a local light, each judged by one
  /// ray to one fixed place of the light that the point would choose at random number 1/2. Without
  /// noise, so that neighboring points may be told apart by it.
  [[nodiscard]] std::uint8_t lit_by(const SurfacePoint& point, std::int64_t& rays) const;

 private:
  struct Bounce {  // a cosine-distributed ray, by sample_ray(); and what it met, by trace()
    Ray ray;
    float pdf = 0.0f;  // per steradian
    glm::vec3 tint{1.0f};
    std::optional<QuadHit> hit;     // looked up by look_up()
    std::optional<ShapeHit> shape;  // then there is no hit
  };
  [[nodiscard]] glm::vec3 aim(const SurfacePoint& point, Sampler& sampler, bool quick,
                              std::int64_t& rays) const;
  struct Aim {
    float weight_against = 0.0f;  // of other rays that find the same light
    bool quick = false;           // Ray::quick
  };
  [[nodiscard]] glm::vec3 shadowed(const SurfacePoint& point, const LightSample& sample,
                                   const Aim& aim, std::int64_t& rays) const;
  [[nodiscard]] bool sample_ray(const SurfacePoint& point, Sampler& sampler, Bounce& bounce) const;
  void trace(Bounce& bounce, std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 look_for_lights(Bounce& bounce, std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 seen(const Bounce& bounce) const;
  [[nodiscard]] bool send(Path& path, int depth, std::int64_t& rays) const;
  void look_up(Path& path) const;
  [[nodiscard]] bool arrive(Path& path, int depth) const;
  [[nodiscard]] bool reflect(Path& path, int depth, std::int64_t& rays) const;

  World world_;
  int bounces_;
};

/// One sample of indirect light.
struct PathTracer::Path {
  Path() : sampler(0, 0) {}
  Path(const SurfacePoint& point, const Sampler& s) : Path() { start(point, s); }
  /// The same as a new path.
  void start(const SurfacePoint& point, const Sampler& s) {
    at = point;
    sampler = s;
    light = glm::vec3(0.0f);
    throughput_ = glm::vec3(1.0f);
  }

  SurfacePoint at;
  Sampler sampler;
  glm::vec3 light{0.0f};  ///< the result

 private:
  friend class PathTracer;
  glm::vec3 throughput_{1.0f};
  const std::uint32_t* texel_ = nullptr;  // of `at`, not yet in its albedo
  Bounce bounce_;
};

}  // namespace eigenlight
