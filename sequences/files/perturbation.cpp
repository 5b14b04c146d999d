#include "sequences/files/perturbation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "frame/check.h"

namespace eigenlight {
namespace {

constexpr int kLastStepFrame = 1'000'000;

constexpr std::array<std::pair<std::string_view, Perturbation::Kind>, 5> kNames{
    {{"none", Perturbation::kNone},
     {"lights", Perturbation::kLights},
     {"objects", Perturbation::kObjects},
     {"step", Perturbation::kStep},
     {"all", Perturbation::kAll}}};

}  // namespace

Perturbation parse_perturbation(std::string_view text) {
  const std::string_view name = text.substr(0, text.find(':'));
  const auto found = std::find_if(kNames.begin(), kNames.end(),
                                  [name](const auto& entry) { return entry.first == name; });
  const bool has_frame = name.size() < text.size();
  EL_CHECK(found != kNames.end() && (!has_frame || found->second == Perturbation::kStep),
           "unknown perturbation '{}'; known: none, lights, objects, all, step, step:FRAME", text);
  Perturbation perturbation(found->second);
  if (!has_frame) return perturbation;
  const std::string_view digits = text.substr(name.size() + 1);
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, perturbation.step_frame);
  EL_CHECK(error == std::errc{} && stop == end && perturbation.step_frame >= 1 &&
               perturbation.step_frame <= kLastStepFrame,
           "perturbation '{}': expected step:FRAME with a frame of 1 to {}", text, kLastStepFrame);
  return perturbation;
}

std::string format_perturbation(const Perturbation& perturbation) {
  if (perturbation.kind == Perturbation::kStep) {
    return fmt::format("step:{}", perturbation.step_frame);
  }
  const auto found = std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) {
    return entry.second == perturbation.kind;
  });
  return std::string(found->first);
}

}  // namespace eigenlight
