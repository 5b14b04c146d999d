#include "sequences/cli/stress_command.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

struct Result {
  StressCase what;
  StressFinding finding;
  int frames = 0, worst_step = 0;
  double seconds = 0.0;
};

std::vector<StressCase> chosen(const StressSettings& settings) {
  std::vector<StressCase> found;
  std::string names;
  for (const StressCase& c : stress_cases()) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", c.name);
    const bool theme = c.name.starts_with(settings.only + ".");
    const bool in_turn = settings.takes_long || !c.is_long;
    if (settings.only == c.name || (in_turn && (theme || settings.only.empty())))
      found.push_back(c);
  }
  EL_CHECK(!found.empty(), "unknown case '{}'; known: {}", settings.only, names);
  return found;
}

Result run(const StressCase& stress_case, std::uint32_t seed) {
  const auto start = std::chrono::steady_clock::now();
  Lab lab(seed);
  Result result{stress_case, stress_case.run(lab), lab.steps(), lab.worst_step(), 0.0};
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  result.seconds = time.count();
  return result;
}

constexpr std::string_view kRow = "{:<24}{:>8}  {:>12}  {:>10}  {:<5}{:>7}  {}\n";

std::string row(const Result& result) {
  const StressFinding& f = result.finding;
  std::string what(result.what.what);
  for (const std::string& more : {f.where, f.note}) {
    if (!more.empty()) what += "; " + more;
  }
  return fmt::format(fmt::runtime(kRow), result.what.name, result.frames,
                     fmt::format("{:.4g}", f.figure), fmt::format("{:.4g}", f.bound),
                     f.pass() ? "yes" : "NO", fmt::format("{:.1f}", result.seconds), what);
}

Json to_json(const Result& result) {
  const StressFinding& f = result.finding;
  return {{"name", result.what.name},
          {"frames", result.frames},
          {"figure", std::isfinite(f.figure) ? Json(f.figure) : Json(nullptr)},
          {"bound", f.bound},
          {"pass", f.pass()},
          {"seconds", result.seconds},
          {"what", result.what.what},
          {"where", f.where}};
}

// Runs the case again, up to the frame that was worst, and keeps what is there.
void record(const Result& result, const StressSettings& settings, const Console& console) {
  const std::filesystem::path directory =
      std::filesystem::path(settings.directory) / std::string(result.what.name);
  Lab lab(settings.seed, StressRecording{directory, result.worst_step});
  (void)result.what.run(lab);
  console.err << fmt::format(
      "{} is broken; see before.exr, frame.exr and state.bin in {}, and repeat it with\n"
      "  eigenlight stress --case {} --seed {}\n",
      result.what.name, directory.string(), result.what.name, settings.seed);
}

}  // namespace

int stress_command(const StressSettings& settings, const Console& console) {
  const std::vector<StressCase> cases = chosen(settings);
  Json list = Json::array();
  if (!settings.json) {
    console.out << fmt::format(fmt::runtime(kRow), "case", "frames", "worst", "bound", "pass", "s",
                               "what was checked");
  }
  int broken = 0;
  for (const StressCase& stress_case : cases) {
    const Result result = run(stress_case, settings.seed);
    if (settings.json) {
      list.push_back(to_json(result));
    } else {
      console.out << row(result) << std::flush;
    }
    if (result.finding.pass()) continue;
    ++broken;
    record(result, settings, console);
  }
  if (settings.json) {
    console.out << Json{{"cases", list}}.dump(2) << '\n';
  } else {
    console.out << fmt::format("{} of {} cases within their bounds\n",
                               cases.size() - static_cast<std::size_t>(broken), cases.size());
  }
  return broken > 0 ? 1 : 0;
}

}  // namespace eigenlight
