#include "sequences/cli/stress_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "frame/named.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/machine.h"
#include "sequences/files/markdown.h"
#include "sequences/files/version.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

struct StressSettings {
  bool json = false;
  bool takes_long = false;  // also the cases that take minutes
  std::string only;         // name of a case or of a theme; empty: all
  std::uint32_t seed = 0;
  std::string markdown;                  // file for the table in Markdown; empty: none
  std::string directory = "out/stress";  // for the records of failing cases
};

struct Result {
  StressCase what;
  StressFinding finding;
  int frames = 0, worst_step = 0;
  double seconds = 0.0;
};

std::vector<StressCase> chosen(const StressSettings& settings) {
  const std::vector<StressCase> all = stress_cases();
  std::vector<StressCase> found;
  for (const StressCase& c : all) {
    const bool theme = c.name.starts_with(settings.only + ".");
    const bool in_turn = settings.takes_long || !c.is_long;
    if (settings.only == c.name || (in_turn && (theme || settings.only.empty())))
      found.push_back(c);
  }
  EL_CHECK(!found.empty(), "unknown case '{}'; known: {}", settings.only, names_of(all));
  return found;
}

Result run(const StressCase& stress_case, std::uint32_t seed) {
  const auto start = std::chrono::steady_clock::now();
  StressLog log(seed);
  Result result{stress_case, stress_case.run(log), log.steps(), log.worst_step(), 0.0};
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  result.seconds = time.count();
  return result;
}

constexpr std::string_view kRow = "{:<24}{:>8}  {:>12}  {:>10}  {:<5}{:>7}  {}\n";

// What was checked, where the worst figure was, and the case's note.
std::string explanation(const Result& result) {
  std::string what(result.what.what);
  for (const std::string& more : {result.finding.where, result.finding.note}) {
    if (!more.empty()) what += "; " + more;
  }
  return what;
}

std::string row(const Result& result) {
  const StressFinding& f = result.finding;
  return fmt::format(fmt::runtime(kRow), result.what.name, result.frames,
                     fmt::format("{:.4g}", f.figure), fmt::format("{:.4g}", f.bound),
                     f.pass() ? "yes" : "NO", fmt::format("{:.1f}", result.seconds),
                     explanation(result));
}

std::string verdict(const std::vector<Result>& results) {
  const auto passed = std::count_if(results.begin(), results.end(),
                                    [](const Result& result) { return result.finding.pass(); });
  return fmt::format("{} of {} cases within their bounds", passed, results.size());
}

constexpr const char* kMarkdownHead =
    R"(# Robustness

`eigenlight stress` runs the denoiser on light whose truth is known: NaN, Inf and invalid values in every layer,
fireflies, degenerate bases, cuts, sizes from 1x1 to 7680x4320, 1000 seeds of noise, thread counts, tile orders and
instruction sets. `--long` adds runs of up to 100,000 frames; `--case NAME` runs one case. The worst figure of each
case must not exceed its bound. Why each bound holds: [method](method.md#why-it-is-stable).

| | |
| --- | --- |
| date | {} |
| command | `{}` |
| program | {} |
| machine | {} |
| result | {}, in {:.1f} minutes |

The command writes this file whole.

)";

std::string command_text(const StressSettings& settings) {
  std::string text = "eigenlight stress";
  if (settings.takes_long) text += " --long";
  if (!settings.only.empty()) text += " --case " + settings.only;
  if (settings.seed != 0) text += fmt::format(" --seed {}", settings.seed);
  return text + " --markdown FILE";
}

std::string to_markdown(const std::vector<Result>& results, const StressSettings& settings) {
  std::vector<std::vector<std::string>> rows;
  double seconds = 0.0;
  for (const Result& result : results) {
    const StressFinding& f = result.finding;
    seconds += result.seconds;
    rows.push_back({fmt::format("`{}`", result.what.name), explanation(result),
                    fmt::format("{}", result.frames), fmt::format("{:.4g}", f.figure),
                    fmt::format("{:.4g}", f.bound), f.pass() ? "yes" : "**NO**"});
  }
  return fmt::format(kMarkdownHead, today(), command_text(settings), program_version(),
                     to_text(this_machine()), verdict(results), seconds / 60.0) +
         markdown_table({"case", "what was checked", "frames", "worst", "bound", "within"}, rows,
                        2);
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
  StressLog log(settings.seed, StressRecording{directory, result.worst_step});
  (void)result.what.run(log);
  console.err << fmt::format(
      "{} is broken; see before.exr, frame.exr and state.bin in {}, and repeat it with\n"
      "  eigenlight stress --case {} --seed {}\n",
      result.what.name, directory.string(), result.what.name, settings.seed);
}

int run_cases(const StressSettings& settings, const Console& console) {
  const std::vector<StressCase> cases = chosen(settings);
  Json list = Json::array();
  if (!settings.json) {
    console.out << fmt::format(fmt::runtime(kRow), "case", "frames", "worst", "bound", "pass", "s",
                               "what was checked");
  }
  std::vector<Result> results;
  for (const StressCase& stress_case : cases) {
    const Result& result = results.emplace_back(run(stress_case, settings.seed));
    if (settings.json) {
      list.push_back(to_json(result));
    } else {
      console.out << row(result) << std::flush;
    }
    if (!result.finding.pass()) record(result, settings, console);
  }
  if (settings.json) {
    console.out << Json{{"cases", list}}.dump(2) << '\n';
  } else {
    console.out << verdict(results) << '\n';
  }
  if (!settings.markdown.empty()) {
    write_file_atomically(settings.markdown, to_markdown(results, settings));
  }
  return std::all_of(results.begin(), results.end(),
                     [](const Result& result) { return result.finding.pass(); })
             ? kSuccess
             : kFailed;
}

}  // namespace

Command add_stress_command(CLI::App& app) {
  CLI::App* parser = app.add_subcommand("stress", "Run cases that must not break the denoiser");
  const auto settings = std::make_shared<StressSettings>();
  parser->add_flag("--json", settings->json, "Print JSON instead of the table");
  parser->add_flag("--long", settings->takes_long, "Also run cases that take minutes");
  parser->add_option("--case", settings->only, "One case, or one theme such as values");
  parser->add_option("--seed", settings->seed, "Seed of the noise")->capture_default_str();
  parser->add_option("--markdown", settings->markdown, "File for the table in Markdown");
  parser
      ->add_option("-o,--output", settings->directory,
                   "Directory for the frames and states of failing cases")
      ->capture_default_str();
  return {parser, [settings](const Console& console) { return run_cases(*settings, console); }};
}

}  // namespace eigenlight
