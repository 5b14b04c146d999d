#include "sequences/compare/reference_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sequences/files/atomic_file.h"
#include "sequences/files/compose.h"
#include "sequences/files/directory.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/runs/render_plan.h"

namespace eigenlight {
namespace {

// The upper half of all seeds belongs to references (render_plan.cpp); of these, those of A are
// even and those of B odd.
constexpr std::uint32_t kReferenceSeeds = 0x80000000U;

std::string describe(const ReferenceIdentity& identity) {
  nlohmann::ordered_json json{{"scene", identity.scene},
                              {"scene_hash", fmt::format("{:016x}", identity.scene_hash)},
                              {"perturb", identity.perturb},
                              {"width", identity.extent.width},
                              {"height", identity.extent.height},
                              {"bounces", identity.bounces},
                              {"spp", identity.spp},
                              {"seed", identity.seed},
                              {"renderer", fmt::format("{:016x}", identity.renderer)}};
  if (identity.is_whole) json["layer"] = "color";
  if (identity.antialias) json["antialias"] = format_antialias(*identity.antialias);
  return json.dump(2) + "\n";
}

std::string directory_name(const ReferenceIdentity& identity, const std::string& description) {
  const std::uint64_t hash = XXH3_64bits(description.data(), description.size());
  return fmt::format("{}-{}x{}-{}spp-{:016x}", identity.scene, identity.extent.width,
                     identity.extent.height, identity.spp, hash);
}

std::uint64_t hash_rows(const Planes<3>& planes) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       XXH3_freeState);
  XXH3_64bits_reset(state.get());
  for (const Plane<float>& plane : planes) {
    for (int y = 0; y < plane.height(); ++y) {
      const auto bytes = static_cast<std::size_t>(plane.width()) * sizeof(float);
      XXH3_64bits_update(state.get(), plane.row(y), bytes);
    }
  }
  return XXH3_64bits_digest(state.get());
}

RenderOptions options_of(const ReferenceIdentity& identity, ReferenceCache::Half half) {
  RenderOptions options;
  options.extent = identity.extent;
  options.spp = identity.spp;
  options.direct_spp = identity.shows_all() ? kReferenceDirectSpp : 0;
  options.bounces = identity.bounces;
  const bool is_second = half == ReferenceCache::Half::kB;
  options.seed = kReferenceSeeds | (2 * identity.seed + (is_second ? 1U : 0U));
  if (identity.antialias) {
    // The samples are spread over the places within a pixel.
    options.spp = std::max(identity.spp / identity.antialias->samples, 1);
  }
  return options;
}

// What references show of a frame.
void show(LiveSource& source, const Frame& frame, const std::optional<AntialiasOptions>& antialias,
          bool is_whole, Planes<3>& out) {
  const Planes<3>& indirect = frame.lights[0].radiance;
  if (antialias) {
    source.picture(*antialias, frame, indirect, out);
  } else if (is_whole) {
    compose(frame, indirect, out);
  } else {
    modulate(frame.surface.albedo, indirect, out);
  }
}

}  // namespace

std::uint64_t renderer_hash(const AnimatedScene& animated, const RenderOptions& options,
                            const std::optional<AntialiasOptions>& antialias, bool is_whole) {
  RenderOptions probe = options;
  probe.spp = 1;
  probe.direct_spp = antialias || is_whole ? 1 : 0;
  LiveSource source(animated.scene, animated.animation, probe, {0});
  Frame frame;
  if (!source.next(frame)) throw std::logic_error("a source of one frame has one");
  Planes<3> light;
  show(source, frame, antialias, is_whole, light);
  return hash_rows(light);
}

ReferenceCache::ReferenceCache(const std::filesystem::path& root, const ReferenceIdentity& identity)
    : identity_(identity) {
  const std::string description = describe(identity);
  path_ = root / directory_name(identity, description);
  make_directory(path_ / "a");
  make_directory(path_ / "b");
  write_file_atomically(path_ / "reference.json", description);
}

std::filesystem::path ReferenceCache::file(Half half, int frame) const {
  return path_ / (half == Half::kA ? "a" : "b") / FilePattern(kFramePattern).name(frame);
}

std::vector<int> ReferenceCache::missing(Half half, const std::vector<int>& frames) const {
  std::vector<int> absent;
  for (const int frame : frames) {
    if (!std::filesystem::exists(file(half, frame))) absent.push_back(frame);
  }
  return absent;
}

void ReferenceCache::render(Half half, const std::vector<int>& frames,
                            const AnimatedScene& animated, const RunControl& control) const {
  LiveSource source(animated.scene, animated.animation, options_of(identity_, half), frames);
  Frame frame;
  Planes<3> light;
  while (source.next(frame)) {
    show(source, frame, identity_.antialias, identity_.is_whole, light);
    const std::string layer = identity_.shows_all() ? "" : "indirect.";
    const ExrChannel channels[] = {{layer + "R", ExrType::kFloat, &light[0]},
                                   {layer + "G", ExrType::kFloat, &light[1]},
                                   {layer + "B", ExrType::kFloat, &light[2]},
                                   {"id", ExrType::kUint, &frame.surface.id}};
    write_exr(file(half, frame.index), channels, {});
    control.frame_done(frame.index);
    if (control.stops()) return;
  }
}

Planes<3> ReferenceCache::load(Half half, int frame) const {
  const std::filesystem::path path = file(half, frame);
  Planes<3> planes = ExrReader(path).read_planes<3>(identity_.shows_all() ? "" : "indirect");
  const Extent size = planes[0].extent();
  if (size == identity_.extent) return planes;
  throw std::runtime_error(fmt::format("{} is {}x{}, expected {}x{}", path.string(), size.width,
                                       size.height, identity_.extent.width,
                                       identity_.extent.height));
}

}  // namespace eigenlight
