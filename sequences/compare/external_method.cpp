#include "sequences/compare/external_method.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <regex>
#include <stdexcept>
#include <utility>

#include "sequences/compare/child_process.h"
#include "sequences/files/compose.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/shell_quote.h"

namespace eigenlight {
namespace {

constexpr std::array<std::string_view, 7> kPlaces{"color", "albedo", "normal",    "output",
                                                  "frame", "frames", "all_frames"};

bool has_place(std::string_view command, std::string_view place) {
  return command.find(fmt::format("{{{}}}", place)) != std::string_view::npos;
}

void check_places(const ExternalMethod& method) {
  // Only words of lower case: ${VARIABLES} and awk's braces are the shell's.
  static const std::regex kPlace("(^|[^$])\\{([a-z_]+)\\}");
  const auto end = std::sregex_iterator();
  for (auto it = std::sregex_iterator(method.command.begin(), method.command.end(), kPlace);
       it != end; ++it) {
    const std::string place = (*it)[2];
    EL_CHECK(std::find(kPlaces.begin(), kPlaces.end(), place) != kPlaces.end(),
             "external '{}': unknown place '{{{}}}'; known: {{{}}}", method.name, place,
             fmt::format("{}", fmt::join(kPlaces, "}, {")));
  }
  for (const std::string_view needed : {"color", "output"}) {
    EL_CHECK(has_place(method.command, needed), "external '{}': its command has no {{{}}}",
             method.name, needed);
  }
  EL_CHECK(!has_place(method.command, "frame") || !method.runs_per_sequence(),
           "external '{}': {{frame}} is for one run a frame, {{frames}} for one a sequence",
           method.name);
}

std::pair<std::string, std::string> split_name(std::string_view option, std::string_view text) {
  const std::size_t equal = text.find('=');
  EL_CHECK(equal != std::string_view::npos && equal > 0 && equal + 1 < text.size(),
           "{} '{}': expected NAME=...", option, text);
  return {std::string(text.substr(0, equal)), std::string(text.substr(equal + 1))};
}

std::string first_line(const ChildResult& result) {
  for (const std::string& text : {result.err, result.out}) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string::npos) continue;
    return text.substr(begin, text.find('\n', begin) - begin);
  }
  return "it printed nothing";
}

double printed_ms(const ExternalMethod& method, const ChildResult& result) {
  const std::string text = result.out + "\n" + result.err;
  const std::regex pattern(method.time_pattern);
  double ms = 0.0;
  int matches = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), pattern);
       it != std::sregex_iterator(); ++it) {
    const std::string number = (*it)[1];
    char* end = nullptr;
    ms += std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0') {
      throw std::runtime_error(
          fmt::format("external '{}': its time '{}' is not a number", method.name, number));
    }
    ++matches;
  }
  if (matches == 0) {
    throw std::runtime_error(fmt::format("external '{}': nothing that it printed matches '{}'",
                                         method.name, method.time_pattern));
  }
  return ms;
}

}  // namespace

bool ExternalMethod::wants(std::string_view place) const { return has_place(command, place); }

bool ExternalMethod::runs_per_sequence() const {
  return has_place(command, "frames") || takes_all_frames();
}

bool ExternalMethod::takes_all_frames() const { return has_place(command, "all_frames"); }

ExternalMethod parse_external(std::string_view text) {
  auto [name, command] = split_name("external", text);
  ExternalMethod method{std::move(name), std::move(command), ""};
  check_places(method);
  return method;
}

void set_external_time(std::string_view text, std::vector<ExternalMethod>& methods) {
  const auto [name, pattern] = split_name("external-time", text);
  std::string known;
  for (ExternalMethod& method : methods) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", method.name);
    if (method.name != name) continue;
    try {
      EL_CHECK(std::regex(pattern).mark_count() >= 1,
               "external-time '{}': expected a group (...) around the milliseconds", pattern);
    } catch (const std::regex_error& error) {
      throw std::invalid_argument(fmt::format("external-time '{}': {}", pattern, error.what()));
    }
    method.time_pattern = pattern;
    return;
  }
  throw std::invalid_argument(fmt::format("external-time: unknown external '{}'; known: {}", name,
                                          known.empty() ? "none" : known));
}

ExternalRun::ExternalRun(const ExternalMethod& method, Frames frames, std::filesystem::path scratch)
    : method_(method), frames_(std::move(frames)), scratch_(std::move(scratch)) {}

const std::vector<int>& ExternalRun::frames() const {
  return method_.takes_all_frames() ? frames_.all : frames_.measured;
}

std::string ExternalRun::path(std::string_view role, int frame) const {
  return (scratch_ / FilePattern(fmt::format("{}.####.exr", role)).name(frame)).string();
}

bool ExternalRun::takes(int frame) const {
  return std::binary_search(frames().begin(), frames().end(), frame);
}

void ExternalRun::add(const ExternalInputs& inputs) const {
  write_float_layer(path("color", inputs.frame), "RGB", inputs.color);
  if (method_.wants("albedo")) {
    write_float_layer(path("albedo", inputs.frame), "RGB", inputs.albedo);
  }
  if (method_.wants("normal")) {
    write_float_layer(path("normal", inputs.frame), "XYZ", inputs.normal);
  }
}

void ExternalRun::add(const Frame& frame) const {
  if (!takes(frame.index)) return;
  Planes<3> color;
  modulate(frame.surface.albedo, frame.lights[0].radiance, color);
  add({frame.index, color, frame.surface.albedo, frame.surface.normal});
}

std::string ExternalRun::fill(int frame) const {
  std::map<std::string, std::string> values{
      {"frame", fmt::format("{}", frame)},
      {"frames", format_frame_range(frames_.measured)},
      {"all_frames", format_frame_range(frames_.all)},
  };
  for (const char* role : {"color", "albedo", "normal", "output"}) {
    const std::string sequence = (scratch_ / fmt::format("{}.%04d.exr", role)).string();
    values[role] = quote_for_shell(method_.runs_per_sequence() ? sequence : path(role, frame));
  }
  std::string command = method_.command;
  for (const auto& [place, value] : values) {
    const std::string open = fmt::format("{{{}}}", place);
    for (std::size_t at = 0; (at = command.find(open, at)) != std::string::npos;) {
      command.replace(at, open.size(), value);
      at += value.size();
    }
  }
  return command;
}

bool ExternalRun::run(const std::function<bool()>& stops, ExternalCost& cost) const {
  cost = {};
  const std::vector<int> once{frames().front()};
  for (const int frame : method_.runs_per_sequence() ? once : frames()) {
    if (stops()) return false;
    const ChildResult result = run_shell(fill(frame), scratch_);
    // Ctrl-C reaches the program too.
    if (stops()) return false;
    if (result.status != 0) {
      throw std::runtime_error(fmt::format("external '{}': exit status {}: {}", method_.name,
                                           result.status, first_line(result)));
    }
    cost.ms += method_.time_pattern.empty() ? result.cpu_ms : printed_ms(method_, result);
    cost.peak_mb = std::max(cost.peak_mb, result.peak_mb);
  }
  cost.ms /= static_cast<double>(frames().size());
  for (const int frame : frames_.measured) {
    if (std::filesystem::exists(path("output", frame))) continue;
    throw std::runtime_error(
        fmt::format("external '{}': it left no {}", method_.name, path("output", frame)));
  }
  return true;
}

Planes<3> ExternalRun::output(int frame, Extent extent) const {
  const std::string file = path("output", frame);
  Planes<3> planes = ExrReader(file).read_planes<3>("");
  const Extent size = planes[0].extent();
  if (size != extent) {
    throw std::runtime_error(fmt::format("external '{}': {} is {}x{}, expected {}x{}", method_.name,
                                         file, size.width, size.height, extent.width,
                                         extent.height));
  }
  return planes;
}

}  // namespace eigenlight
