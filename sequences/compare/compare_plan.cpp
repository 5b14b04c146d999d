#include "sequences/compare/compare_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <set>

#include "frame/check.h"
#include "render/live_source.h"
#include "sequences/compare/compare_contenders.h"
#include "sequences/compare/recorded_plan.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/split_list.h"
#include "sequences/runs/render_plan.h"
#include "temporal/methods.h"

namespace eigenlight {
namespace {

constexpr int kMostSpp = 65536;

void check_range(std::string_view name, std::int64_t value, std::int64_t low, std::int64_t high) {
  EL_CHECK(value >= low && value <= high, "{} {}: expected {} to {}", name, value, low, high);
}

// `atrium`; of a file its name, or that of its folder for `sponza/scene.json`.
std::string scene_word(const std::string& scene) {
  std::filesystem::path path = std::filesystem::path(scene).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  if (path.filename() == "scene.json" && path.has_parent_path()) path = path.parent_path();
  return file_word(path.stem().string());
}

struct SceneText {
  std::string scene, perturb;
};

// `atrium:none,lights` names its own perturbations, unless there is a file of that name.
SceneText split_scene(const std::string& text, const std::string& perturb) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || std::filesystem::exists(text)) return {text, perturb};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

std::vector<CompareCase> make_cases(const CompareSettings& settings) {
  EL_CHECK(!settings.scenes.empty(), "no scene to compare on");
  std::vector<CompareCase> cases;
  std::set<std::string> names;
  for (const std::string& text : settings.scenes) {
    const auto [scene, perturbs] = split_scene(text, settings.perturb);
    EL_CHECK(!perturbs.empty(), "scene '{}': no perturbation, expected names with commas", text);
    for (const std::string& perturb : split_list("perturb", perturbs)) {
      const Perturbation perturbation = parse_perturbation(perturb);
      CompareCase one{scene_word(scene), scene, format_perturbation(perturbation), perturbation};
      if (perturb != "none") one.name += fmt::format("-{}", file_word(one.perturb));
      EL_CHECK(names.insert(one.name).second, "scene '{}': a second one called '{}'", scene,
               one.name);
      cases.push_back(std::move(one));
    }
  }
  return cases;
}

void set_frames(const CompareSettings& settings, ComparePlan& plan) {
  plan.measured = parse_frame_range(settings.frames);
  const auto gap = std::adjacent_find(plan.measured.begin(), plan.measured.end(),
                                      [](int a, int b) { return b != a + 1; });
  EL_CHECK(gap == plan.measured.end(),
           "frames '{}': expected one range without gaps, such as 40-59", settings.frames);
  EL_CHECK(plan.measured.front() >= 0, "frames '{}': flythroughs start at frame 0",
           settings.frames);
  check_range("warmup", settings.warmup, 0, 1'000'000);
  const int first = std::max(plan.measured.front() - settings.warmup, 0);
  for (int frame = first; frame <= plan.measured.back(); ++frame) plan.frames.push_back(frame);
}

// Direct light is denoised frame by frame as it is rendered.
void set_layer(const CompareSettings& settings, ComparePlan& plan) {
  EL_CHECK(settings.layer.empty() || settings.layer == "indirect" || settings.layer == "color",
           "layer '{}': expected indirect or color", settings.layer);
  plan.is_whole = settings.layer == "color";
  EL_CHECK(!plan.is_whole || !plan.is_antialiasing(), "layer color: --aa compares it anyway");
  for (const Contender& contender : plan.contenders) {
    EL_CHECK(!plan.is_whole || contender.method != "meyer2006",
             "layer color: method 'meyer2006' reads ahead; name others by --methods");
  }
}

// References spread their samples over the places of kAntialiasReference; of the guide rays there
// is one sample count.
void check_antialiasing(const ComparePlan& plan) {
  if (!plan.is_antialiasing()) return;
  EL_CHECK(plan.spp.size() == 1, "spp: {} numbers, expected one with --aa", plan.spp.size());
  EL_CHECK(plan.reference_spp % kAntialiasReference.samples == 0,
           "reference-spp {}: expected a multiple of {} with --aa", 2 * plan.reference_spp,
           2 * kAntialiasReference.samples);
}

}  // namespace

int ComparePlan::shown_spp() const {
  constexpr int kDefault = RenderOptions{}.spp;
  return *std::min_element(spp.begin(), spp.end(), [](int a, int b) {
    return std::abs(a - kDefault) < std::abs(b - kDefault);
  });
}

std::string ComparePlan::shown_text(std::string_view behind) const {
  return recorded ? "" : fmt::format("{} spp{}", shown_spp(), behind);
}

std::string ComparePlan::measured_light() const {
  if (is_antialiasing()) return "the composed picture";
  if (!recorded) {
    return is_whole ? "the whole picture, direct light included" : "indirect light times albedo";
  }
  return recorded->layer == "color" ? "the beauty" : fmt::format("the layer {}", recorded->layer);
}

std::string ComparePlan::reference_text() const {
  if (!recorded) {
    return fmt::format("two independent references of {} samples each, whose noise drops out",
                       reference_spp);
  }
  return recorded->reference_b.empty() ? "one reference, whose own noise counts as error"
                                       : "two independent references, whose noise drops out";
}

const Contender& ComparePlan::ours() const {
  const auto found =
      std::find_if(contenders.begin(), contenders.end(),
                   [](const Contender& contender) { return contender.label == kDefaultMethod; });
  return found == contenders.end() ? contenders.front() : *found;
}

const Contender* ComparePlan::baseline() const {
  for (const Contender& contender : contenders) {
    const bool is_raw = contender.antialias ? contender.antialias->mode == AntialiasMode::kNone
                                            : contender.method == "noisy";
    if (is_raw) return &contender;
  }
  return nullptr;
}

bool ComparePlan::is_antialiasing() const { return contenders.front().antialias.has_value(); }

ComparePlan make_compare_plan(const CompareSettings& settings) {
  if (is_recorded(settings)) return make_recorded_plan(settings);
  ComparePlan plan;
  plan.cases = make_cases(settings);
  plan.contenders = make_contenders(settings);
  plan.spp = split_numbers("spp", settings.spp, {1, kMostSpp});
  EL_CHECK(!plan.spp.empty(), "spp '': expected numbers with commas, such as 1,2,4");
  std::sort(plan.spp.begin(), plan.spp.end());
  set_layer(settings, plan);
  set_frames(settings, plan);
  plan.extent = parse_size(settings.size);
  check_range("bases", settings.bases, 1, 8);
  check_range("bounces", settings.bounces, 1, 64);
  // References have half as many seeds as all else: two of them for each.
  check_range("seed", settings.seed, 0, (std::int64_t{1} << 30) - 1);
  check_range("reference-spp", settings.reference_spp, 2, 2 * kMostSpp);
  EL_CHECK(settings.reference_spp % 2 == 0,
           "reference-spp {}: expected an even number, half for each of two references",
           settings.reference_spp);
  EL_CHECK(!settings.equal_time || *settings.equal_time > 0.0,
           "equal-time {}: expected milliseconds above 0", *settings.equal_time);
  plan.bases = settings.bases;
  plan.bounces = settings.bounces;
  plan.seed = static_cast<std::uint32_t>(settings.seed);
  plan.environment = settings.environment;
  plan.reference_spp = settings.reference_spp / 2;
  plan.equal_time = settings.equal_time;
  plan.crop = make_crop(settings, plan.extent);
  plan.cache = settings.cache;
  plan.directory = settings.directory;
  check_antialiasing(plan);
  return plan;
}

}  // namespace eigenlight
