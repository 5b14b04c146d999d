// Motion readings as text.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "frame/check.h"
#include "sequences/conventions/motion_reading.h"

namespace eigenlight {
namespace {

struct Preset {
  std::string_view name, words;
};

// Cycles: measured. OptiX: the flow guide of its denoiser, current minus previous. V-Ray: its
// manual says current to next; the unit is the scene's maximum, so the sign is all that is known.
// Arnold scales by the shutter. No source states the signs of Arnold and RenderMan: the usual ones.
constexpr std::array<Preset, 5> kPresets{{
    {"cycles", "x,-y,pixels,backward"},
    {"arnold", "-x,y,pixels,forward"},
    {"renderman", "x,y,pixels,backward"},
    {"vray", "-x,y,pixels,forward"},
    {"optix", "-x,-y,pixels,backward"},
}};

std::string known() {
  std::string text = "none";
  for (const Preset& preset : kPresets) text += fmt::format(", {} ({})", preset.name, preset.words);
  return text +
         ", or words between commas: x or -x; y or -y; pixels, uv, ndc or pixels per unit; "
         "backward "
         "or forward; first or second";
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t comma = text.find(',');
    std::string_view word = text.substr(0, comma);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    words.push_back(word);
    if (comma == std::string_view::npos) return words;
    text.remove_prefix(comma + 1);
  }
}

struct Words {
  double sign_x = 1, sign_y = 1;
  glm::dvec2 unit{1.0};
  int pair = 0;
  bool backward = true;
  std::array<bool, 5> said{};  // x, y, unit, direction, pair
};

// What kind of word it is, or -1.
int take(std::string_view word, Extent extent, Words& words) {
  const glm::dvec2 size(extent.width, extent.height);
  if (word == "x" || word == "-x") return words.sign_x = word == "x" ? 1 : -1, 0;
  if (word == "y" || word == "-y") return words.sign_y = word == "y" ? 1 : -1, 1;
  if (word == "pixels") return words.unit = glm::dvec2(1.0), 2;
  if (word == "uv") return words.unit = size, 2;
  if (word == "ndc") return words.unit = 0.5 * size, 2;
  if (word == "backward" || word == "forward") return words.backward = word == "backward", 3;
  if (word == "first" || word == "second") return words.pair = word == "first" ? 0 : 1, 4;
  double number = 0.0;
  const char* const last = word.data() + word.size();
  const auto [end, error] = std::from_chars(word.data(), last, number);
  if (error != std::errc() || !std::isfinite(number) || number <= 0.0) return -1;
  const std::string_view rest(end, static_cast<std::size_t>(last - end));
  if (rest != "" && rest != "uv") return -1;
  return words.unit = number * (rest.empty() ? glm::dvec2(1.0) : size), 2;
}

}  // namespace

std::optional<MotionReading> parse_motion(std::string_view text, Extent extent) {
  check_extent(extent);
  if (text == "none") return std::nullopt;
  const auto preset = std::find_if(kPresets.begin(), kPresets.end(),
                                   [&](const Preset& p) { return p.name == text; });
  Words words;
  for (const std::string_view word : split(preset == kPresets.end() ? text : preset->words)) {
    const int kind = take(word, extent, words);
    EL_CHECK(kind >= 0, "motion: unknown '{}' in '{}'; known: {}", word, text, known());
    bool& said = words.said.at(static_cast<std::size_t>(kind));
    EL_CHECK(!said, "motion: '{}' in '{}' says again what was said before; known: {}", word, text,
             known());
    said = true;
  }
  return MotionReading{words.pair, words.sign_x * words.unit.x, words.sign_y * words.unit.y,
                       words.backward};
}

std::string format_motion(const MotionReading& reading, Extent extent) {
  const double x = std::abs(reading.scale_x), y = std::abs(reading.scale_y);
  const double w = extent.width, h = extent.height;
  std::string unit = "pixels";
  if (x == w && y == h && (x != 1.0 || y != 1.0)) {
    unit = "uv";
  } else if (2 * x == w && 2 * y == h) {
    unit = "ndc";
  } else if (x != y) {
    unit = fmt::format("{:.6g}uv", x / w);
  } else if (x != 1.0) {
    unit = fmt::format("{:.6g}", x);
  }
  return fmt::format("{}x,{}y,{},{}{}", reading.scale_x < 0 ? "-" : "",
                     reading.scale_y < 0 ? "-" : "", unit,
                     reading.backward ? "backward" : "forward", reading.pair == 0 ? "" : ",second");
}

}  // namespace eigenlight
