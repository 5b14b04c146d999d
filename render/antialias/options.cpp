#include "render/antialias/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "frame/check.h"

namespace eigenlight {
namespace {

constexpr std::array<std::string_view, 5> kNames{"none", "lookup", "sraa", "sraa-geometry",
                                                 "supersample"};
constexpr std::string_view kSupersample = kNames.back();

int parse_samples(std::string_view text, std::string_view whole) {
  int samples = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, samples);
  EL_CHECK(error == std::errc{} && stop == end && samples >= 2 && samples <= kMaxSupersamples,
           "aa '{}': expected {}:N with N from 2 to {}, such as supersample:16", whole,
           kSupersample, kMaxSupersamples);
  return samples;
}

}  // namespace

AntialiasOptions parse_antialias(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  const auto mode = static_cast<AntialiasMode>(found - kNames.begin());
  const bool counts = name == kSupersample;
  EL_CHECK(found != kNames.end() && (counts || colon == std::string_view::npos),
           "unknown aa '{}'; known: {}:N", text, fmt::format("{}", fmt::join(kNames, ", ")));
  if (!counts) return {mode, 1};
  return {mode, parse_samples(text.substr(std::min(colon, text.size() - 1) + 1), text)};
}

std::string format_antialias(const AntialiasOptions& options) {
  const std::string_view name = kNames[static_cast<std::size_t>(options.mode)];
  if (options.mode != AntialiasMode::kSupersample) return std::string(name);
  return fmt::format("{}:{}", name, options.samples);
}

}  // namespace eigenlight
