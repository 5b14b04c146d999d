#include "render/paths/direct_sampler.h"

#include <algorithm>

namespace eigenlight {
namespace {

constexpr int kReach = 2;  // pixels around one that tell of a penumbra
constexpr std::uint8_t kLit = 1, kHidden = 2, kMixed = kLit | kHidden;

std::uint8_t seen_by(const glm::vec3& light) {
  return std::max({light.x, light.y, light.z}) > 0.0f ? kLit : kHidden;
}

}  // namespace

DirectSampler::DirectSampler(const PathTracer& tracer, Extent extent, const DirectSamples& samples)
    : tracer_(tracer),
      samples_(samples),
      sun_(make_planes<3>(extent)),
      met_(make_planes<3>(extent)),
      soft_(make_planes<3>(extent)),
      first_met_(make_planes<3>(extent)),
      first_soft_(make_planes<3>(extent)),
      seen_(extent) {}

void DirectSampler::add_met(glm::ivec2 at, const glm::vec3& mean, std::uint32_t count,
                            std::uint32_t before) {
  if (samples_.spp == 0 || count == 0) return;
  if (before == 0) return store_pixel(mean, at.x, at.y, met_);
  // sample() has drawn some too.
  const auto further = static_cast<std::uint32_t>(std::max(samples_.spp - samples_.met_spp, 0));
  const float share = static_cast<float>(count) / static_cast<float>(before + count + further);
  const glm::vec3 step = share * (mean - load_pixel(met_, at.x, at.y));
  store_pixel(load_pixel(met_, at.x, at.y) + step, at.x, at.y, met_);
  store_pixel(load_pixel(soft_, at.x, at.y) + step, at.x, at.y, soft_);
}

void DirectSampler::sample(glm::ivec2 at, const GuideHit& hit, std::uint32_t key,
                           RayCounters& tally) {
  seen_(at.x, at.y) = 0;
  if (hit.kind != GuideHit::Kind::kSurface || samples_.spp == 0) {
    for (Planes<3>* planes : {&sun_, &met_, &soft_}) {
      store_pixel(glm::vec3(0.0f), at.x, at.y, *planes);
    }
    return;
  }
  FiniteMean sun, local, met;
  const int further = std::max(samples_.spp - samples_.met_spp, 0);
  for (int i = 0; i < samples_.spp; ++i) {
    Sampler sampler(key, static_cast<std::uint32_t>(i));
    const auto parts = tracer_.direct_parts(hit.point, sampler, i < further, tally.rays);
    sun.add(parts.sun, tally);
    local.add(parts.local, tally);
    if (i < further) met.add(parts.met, tally);
    seen_(at.x, at.y) = static_cast<std::uint8_t>(seen_(at.x, at.y) | seen_by(parts.sun));
  }
  if (further > 0) {
    const glm::vec3 known = samples_.met_spp > 0 ? load_pixel(met_, at.x, at.y) : glm::vec3(0.0f);
    const float share = static_cast<float>(further) / static_cast<float>(samples_.spp);
    store_pixel(known + share * (met.value() - known), at.x, at.y, met_);
  }
  store_pixel(sun.value(), at.x, at.y, sun_);
  store_pixel(local.value() + load_pixel(met_, at.x, at.y), at.x, at.y, soft_);
}

bool DirectSampler::is_penumbra(glm::ivec2 at) const {
  if (samples_.penumbra_spp <= samples_.spp || seen_(at.x, at.y) == 0) return false;
  std::uint8_t seen = 0;
  for (int y = std::max(at.y - kReach, 0); y <= std::min(at.y + kReach, seen_.height() - 1); ++y) {
    for (int x = std::max(at.x - kReach, 0); x <= std::min(at.x + kReach, seen_.width() - 1); ++x) {
      if (x == at.x && y == at.y) continue;
      seen = static_cast<std::uint8_t>(seen | seen_(x, y));
    }
  }
  return seen == kMixed;
}

void DirectSampler::refine(glm::ivec2 at, const GuideHit& hit, std::uint32_t key,
                           RayCounters& tally) {
  FiniteMean more;
  for (int i = samples_.spp; i < samples_.penumbra_spp; ++i) {
    Sampler sampler(key, static_cast<std::uint32_t>(i));
    more.add(tracer_.sun_light(hit.point, sampler, tally.rays), tally);
  }
  const float share =
      1.0f - static_cast<float>(samples_.spp) / static_cast<float>(samples_.penumbra_spp);
  const glm::vec3 first = load_pixel(sun_, at.x, at.y);
  store_pixel(first + share * (more.value() - first), at.x, at.y, sun_);
}

void DirectSampler::finish() {
  copy_planes(met_, first_met_);
  copy_planes(soft_, first_soft_);
}

void DirectSampler::rewind() {
  copy_planes(first_met_, met_);
  copy_planes(first_soft_, soft_);
}

}  // namespace eigenlight
