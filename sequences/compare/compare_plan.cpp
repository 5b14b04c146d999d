#include "sequences/compare/compare_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <regex>
#include <set>

#include "frame/check.h"
#include "render/live_source.h"
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

// Letters, digits, `_`, `-` and `.`; all others become `-`.
std::string as_word(std::string text) {
  for (char& c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.') c = '-';
  }
  return text.empty() || text[0] == '.' ? fmt::format("scene{}", text) : text;
}

// `atrium`; of a file its name, or that of its folder for `sponza/scene.json`.
std::string scene_word(const std::string& scene) {
  std::filesystem::path path = std::filesystem::path(scene).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  if (path.filename() == "scene.json" && path.has_parent_path()) path = path.parent_path();
  return as_word(path.stem().string());
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
      if (perturb != "none") one.name += fmt::format("-{}", as_word(one.perturb));
      EL_CHECK(names.insert(one.name).second, "scene '{}': a second one called '{}'", scene,
               one.name);
      cases.push_back(std::move(one));
    }
  }
  return cases;
}

const Method* find_method(const std::string& name) {
  for (const Method& method : methods()) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

void add_method(const std::string& name, std::vector<Contender>& contenders) {
  std::string known;
  for (const Method& method : methods()) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", method.name);
  }
  EL_CHECK(find_method(name), "unknown method '{}'; known: {}", name, known);
  contenders.push_back({name, name, "", {}});
}

// `eigenlight`, if it is not there yet, and once more without each of its parts.
void add_ablations(std::vector<Contender>& contenders) {
  const std::string name(kDefaultMethod);
  const Method* method = find_method(name);
  EL_CHECK(!method->parts.empty(), "ablate: method '{}' has no parts to turn off", name);
  const bool present = std::any_of(contenders.begin(), contenders.end(),
                                   [&](const Contender& c) { return c.label == name; });
  if (!present) contenders.insert(contenders.begin(), {name, name, "", {}});
  for (const Part& part : method->parts) {
    contenders.push_back(
        {fmt::format("{}-without-{}", name, part.name), name, std::string(part.name), {}});
  }
}

void add_externals(const CompareSettings& settings, std::vector<Contender>& contenders) {
  std::vector<ExternalMethod> externals;
  for (const std::string& text : settings.external) externals.push_back(parse_external(text));
  for (const std::string& text : settings.external_time) set_external_time(text, externals);
  for (const ExternalMethod& external : externals) {
    const std::string label = as_word(external.name);
    EL_CHECK(std::none_of(contenders.begin(), contenders.end(),
                          [&](const Contender& c) { return c.label == label; }),
             "external '{}': a second method of that name", external.name);
    contenders.push_back({label, "", "", external});
  }
}

std::vector<Contender> make_antialiasing(const std::string& list) {
  std::vector<Contender> contenders;
  for (const std::string& mode : split_list("aa", list)) {
    contenders.push_back({as_word(mode), "", "", {}, parse_antialias(mode)});
  }
  return contenders;
}

std::vector<Contender> make_contenders(const CompareSettings& settings) {
  if (!settings.antialias.empty()) return make_antialiasing(settings.antialias);
  std::vector<Contender> contenders;
  std::vector<std::string> names = split_list("methods", settings.methods);
  if (names.empty() && !settings.ablate) {
    for (const Method& method : methods()) names.emplace_back(method.name);
  }
  for (const std::string& name : names) add_method(name, contenders);
  if (settings.ablate) add_ablations(contenders);
  add_externals(settings, contenders);
  return contenders;
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

// As ImageMagick writes it: 120x96+180+90.
std::optional<CropPlan> make_crop(const CompareSettings& settings, Extent extent) {
  check_range("crops-per-row", settings.crops_per_row, 0, 1000);
  if (settings.crop.empty()) return std::nullopt;
  static const std::regex kGeometry(R"((\d{1,5}x\d{1,5})\+(\d{1,5})\+(\d{1,5}))");
  std::smatch match;
  EL_CHECK(std::regex_match(settings.crop, match, kGeometry),
           "crop '{}': expected WIDTHxHEIGHT+X+Y, such as 120x96+180+90", settings.crop);
  const CropPlan crop{std::stoi(match[2]), std::stoi(match[3]), parse_size(match[1].str()),
                      settings.crops_per_row};
  EL_CHECK(crop.x + crop.size.width <= extent.width && crop.y + crop.size.height <= extent.height,
           "crop '{}': reaches beyond the picture of {}x{}", settings.crop, extent.width,
           extent.height);
  return crop;
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
  ComparePlan plan;
  plan.cases = make_cases(settings);
  plan.contenders = make_contenders(settings);
  plan.spp = split_numbers("spp", settings.spp, {1, kMostSpp});
  EL_CHECK(!plan.spp.empty(), "spp '': expected numbers with commas, such as 1,2,4");
  std::sort(plan.spp.begin(), plan.spp.end());
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
