#include "sequences/runs/render_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "frame/check.h"
#include "frame/named.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/machine.h"
#include "sequences/files/split_list.h"
#include "temporal/methods.h"

namespace eigenlight {
namespace {

// References have the upper half of all seeds, so that no reference shares a sample with an image
// that is measured against it.
constexpr std::int64_t kSeeds = std::int64_t{1} << 31;
constexpr std::uint32_t kReferenceSeeds = 0x80000000U;

bool shows_direct(const std::vector<Layer>& layers) {
  return std::any_of(layers.begin(), layers.end(), [](Layer layer) {
    return layer == Layer::kColor || layer == Layer::kDirect || layer == Layer::kNoisyDirect;
  });
}

// Denoised unless it is not asked for: raw samples alone need no history.
bool denoises_direct(const RenderSettings& settings, const RenderPlan& plan) {
  const bool denoised = settings.direct == "denoised";
  EL_CHECK(denoised || settings.direct == "noisy", "direct '{}': expected denoised or noisy",
           settings.direct);
  return denoised && plan.denoiser != "noisy" && plan.render.direct_spp > 0;
}

// Without this check the kernel might kill the process. Two frames, output and the encoded file
// take about 350 bytes per pixel, a basis twice three floats, and denoised direct light 540 bytes.
void check_memory(const RenderPlan& plan) {
  const Extent extent = plan.render.extent;
  const double bytes = 350.0 + 24.0 * plan.bases + (plan.denoises_direct ? 540.0 : 0.0);
  const double needed = static_cast<double>(extent.pixels()) * bytes;
  const double present = machine_memory();
  EL_CHECK(needed <= present,
           "size {}x{}: needs about {:.0f} GB of memory, this machine has {:.0f}", extent.width,
           extent.height, needed * 1e-9, present * 1e-9);
}

void check_range(std::string_view name, std::int64_t value, std::int64_t low, std::int64_t high) {
  EL_CHECK(value >= low && value <= high, "{} {}: expected {} to {}", name, value, low, high);
}

void check_method(const std::string& name) {
  const bool known = name == kReferenceMethod ||
                     std::any_of(methods().begin(), methods().end(),
                                 [&](const Method& method) { return method.name == name; });
  EL_CHECK(known, "unknown method '{}'; known: {}, {}", name, names_of(methods()),
           kReferenceMethod);
}

}  // namespace

Extent parse_size(std::string_view text) {
  Extent extent;
  const char* end = text.data() + text.size();
  const auto [cross, error] = std::from_chars(text.data(), end, extent.width);
  bool valid = error == std::errc{} && cross != end && *cross == 'x';
  if (valid) {
    const auto [stop, second] = std::from_chars(cross + 1, end, extent.height);
    valid = second == std::errc{} && stop == end;
  }
  valid = valid && extent.width >= 1 && extent.height >= 1 && extent.width <= kMaxSide &&
          extent.height <= kMaxSide;
  EL_CHECK(valid, "size '{}': expected WIDTHxHEIGHT with sides of 1 to {}, such as 640x360", text,
           kMaxSide);
  return extent;
}

RenderPlan make_plan(const RenderSettings& settings) {
  RenderPlan plan;
  plan.method = settings.method;
  check_method(plan.method);
  const bool is_reference = plan.method == kReferenceMethod;
  plan.denoiser = is_reference ? "noisy" : plan.method;
  plan.frames = parse_frame_range(settings.frames);
  check_range("bases", settings.bases, 1, 8);
  check_range("seed", settings.seed, 0, kSeeds - 1);
  plan.bases = settings.bases;
  plan.without = split_list("without", settings.without);
  plan.perturbation = parse_perturbation(settings.perturb);
  plan.perturb = format_perturbation(plan.perturbation);
  plan.antialias = parse_antialias(settings.antialias);
  plan.layers = parse_layers(settings.layers);

  RenderOptions& render = plan.render;
  render.extent = parse_size(settings.size);
  render.spp = settings.spp.value_or(is_reference ? kReferenceSpp : render.spp);
  const int direct_spp =
      settings.direct_spp.value_or(is_reference ? kReferenceDirectSpp : render.direct_spp);
  check_range("direct-spp", direct_spp, 1, 65536);
  render.direct_spp = shows_direct(plan.layers) ? direct_spp : 0;
  plan.denoises_direct = denoises_direct(settings, plan);
  check_memory(plan);
  render.bounces = settings.bounces;
  render.seed = static_cast<std::uint32_t>(settings.seed) | (is_reference ? kReferenceSeeds : 0U);
  check_range("spp", render.spp, 1, 65536);
  check_range("bounces", render.bounces, 1, 64);
  render.validate();
  return plan;
}

}  // namespace eigenlight
