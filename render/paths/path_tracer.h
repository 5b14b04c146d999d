// Path tracer: direct and indirect light at a surface point.
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

/// Geometry, surfaces and lights of a scene. All must outlive the tracer. Poses and lights may
/// change between calls.
struct World {
  const EmbreeScene& geometry;
  const SurfaceTable& surfaces;
  const LightSet& lights;
};

/// Estimates the two parts of the light that a Lambertian surface reflects, divided by its albedo.
/// outgoing = albedo * (direct + indirect) + emission, where
///   direct   = 1/pi * integral of radiance that lights emit * cosine
///   indirect = 1/pi * integral of radiance that other surfaces reflect * cosine.
/// Each call draws one sample. Both are unbiased, except that indirect leaves out paths of more
/// than `bounces` bounces. Light sampling and cosine-distributed rays are combined by the power
/// heuristic (Veach 1997).
class PathTracer {
 public:
  /// `bounces` in [1, 64]; with 1, indirect light has been reflected by one other surface.
  PathTracer(const World& world, int bounces) : world_(world), bounces_(bounces) {}

  /// The parts of a sample of direct light. `sun` has hard edges, and noise nowhere but there.
  /// `local` is from a point of a local light, `met` what a cosine-distributed ray met; together
  /// they are what local lights and the sky give, soft, and as noisy as indirect light.
  struct DirectParts {
    glm::vec3 sun{0.0f}, local{0.0f}, met{0.0f};
  };
  /// One sample, whose parts add up to direct(). Without `sends_ray`, `met` is 0: the first ray of
  /// a path of indirect light (Path::met) can stand for it.
  [[nodiscard]] DirectParts direct_parts(const SurfacePoint& point, Sampler& sampler,
                                         bool sends_ray, std::int64_t& rays) const;
  /// DirectParts::sun alone.
  [[nodiscard]] glm::vec3 sun_light(const SurfacePoint& point, Sampler& sampler,
                                    std::int64_t& rays) const;

  /// One sample; NaN or Inf if the scene contains such values. Adds the number of traced rays to
  /// `rays`.
  [[nodiscard]] glm::vec3 direct(const SurfacePoint& point, Sampler& sampler,
                                 std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 indirect(const SurfacePoint& point, const Sampler& sampler,
                                   std::int64_t& rays) const;

  /// Number of paths traced side by side: enough to hide memory latency, and few enough for the
  /// first-level cache (7 kB).
  static constexpr std::size_t kSideBySide = 32;

  struct Path;
  /// Traces many paths side by side, so that memory is fetched for some while others compute. The
  /// `light` of each path has the same bits as when it is traced alone.
  void indirect(std::span<Path> paths, std::int64_t& rays) const;

  /// Whether a sun lights the point, as bit 0 of lit_by().
  [[nodiscard]] bool sees_sun(const SurfacePoint& point, std::int64_t& rays) const;
  /// Bit 0 is set if a sun lights the point, bit 1 if a local light does. Each bit comes from one
  /// shadow ray to a fixed point of the light that random numbers of 1/2 select. The result has no
  /// noise, so neighboring points can be compared.
  [[nodiscard]] std::uint8_t lit_by(const SurfacePoint& point, std::int64_t& rays) const;

 private:
  [[nodiscard]] bool reaches(const SurfacePoint& point, const std::optional<LightSample>& sample,
                             std::int64_t& rays) const;
  struct Bounce {      // sample_ray() fills the ray, trace() the rest
    Ray ray;           // cosine-distributed
    float pdf = 0.0f;  // per steradian
    glm::vec3 tint{1.0f};
    std::optional<QuadHit> hit;     // refers to a quad until resolve_hit()
    std::optional<ShapeHit> shape;  // excludes `hit`
  };
  [[nodiscard]] glm::vec3 sample_sun(const SurfacePoint& point, Sampler& sampler, bool quick,
                                     std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 sample_local(const SurfacePoint& point, Sampler& sampler, bool quick,
                                       std::int64_t& rays) const;
  struct ShadowRayOptions {
    float weight_against = 0.0f;  // 1: cosine-distributed rays find the light too; 0: they do not
    bool quick = false;           // Ray::quick
  };
  [[nodiscard]] glm::vec3 unoccluded_light(const SurfacePoint& point, const LightSample& sample,
                                           const ShadowRayOptions& options,
                                           std::int64_t& rays) const;
  [[nodiscard]] bool sample_ray(const SurfacePoint& point, Sampler& sampler, Bounce& bounce) const;
  void trace(Bounce& bounce, std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 emission_along(Bounce& bounce, std::int64_t& rays) const;
  [[nodiscard]] glm::vec3 weighted_emission(const Bounce& bounce) const;
  [[nodiscard]] bool send(Path& path, int depth, std::int64_t& rays) const;
  void resolve_hit(Path& path) const;
  [[nodiscard]] bool arrive(Path& path, int depth) const;
  [[nodiscard]] bool reflect(Path& path, int depth, std::int64_t& rays) const;

  World world_;
  int bounces_;
};

/// One path: one sample of indirect light.
struct PathTracer::Path {
  Path() : sampler(0, 0) {}
  Path(const SurfacePoint& point, const Sampler& s) : Path() { start(point, s); }
  /// Resets the path; equal to constructing a new one.
  void start(const SurfacePoint& point, const Sampler& s) {
    at = point;
    sampler = s;
    light = met = glm::vec3(0.0f);
    throughput_ = glm::vec3(1.0f);
  }

  SurfacePoint at;
  Sampler sampler;
  glm::vec3 light{0.0f};  ///< the result
  glm::vec3 met{0.0f};    ///< DirectParts::met, by the first ray of the path

 private:
  friend class PathTracer;
  glm::vec3 throughput_{1.0f};
  const std::uint32_t* texel_ = nullptr;  // of `at`; not yet multiplied into its albedo
  Bounce bounce_;
};

}  // namespace eigenlight
