#include "sequences/compare/compare_contenders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>

#include "frame/check.h"
#include "sequences/files/split_list.h"
#include "sequences/runs/render_plan.h"
#include "temporal/methods.h"

namespace eigenlight {
namespace {

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
    const std::string label = file_word(external.name);
    EL_CHECK(std::none_of(contenders.begin(), contenders.end(),
                          [&](const Contender& c) { return c.label == label; }),
             "external '{}': a second method of that name", external.name);
    contenders.push_back({label, "", "", external});
  }
}

std::vector<Contender> make_antialiasing(const std::string& list) {
  std::vector<Contender> contenders;
  for (const std::string& mode : split_list("aa", list)) {
    contenders.push_back({file_word(mode), "", "", {}, parse_antialias(mode)});
  }
  return contenders;
}

}  // namespace

std::string file_word(std::string text) {
  for (char& c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.') c = '-';
  }
  return text.empty() || text[0] == '.' ? fmt::format("scene{}", text) : text;
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

// As ImageMagick writes it: 120x96+180+90.
std::optional<CropPlan> make_crop(const CompareSettings& settings, Extent extent) {
  EL_CHECK(settings.crops_per_row >= 0 && settings.crops_per_row <= 1000,
           "crops-per-row {}: expected 0 to 1000", settings.crops_per_row);
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

}  // namespace eigenlight
