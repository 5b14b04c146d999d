#include "sequences/cli/evaluate_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "sequences/files/atomic_file.h"
#include "sequences/metrics/figures_json.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

void add_lag(const Lag& lag, Json& json) {
  if (!lag.frames) return;
  json["lag_frames"] = *lag.frames;
  json["lag_error"] = *lag.error;
}

std::string lag_lines(const Evaluation& evaluation) {
  if (!evaluation.lag) return {};
  const Lag& lag = *evaluation.lag;
  if (lag.frames) {
    return fmt::format(
        "lag: {} frames after the light step at {} to 90 % of it, relmse {:.6g} summed\n",
        *lag.frames, *evaluation.step, *lag.error);
  }
  double most = 0.0;
  for (const auto& [frame, reached] : lag.reached) most = std::max(most, reached);
  return fmt::format("lag: not 90 % of the light step at {}, {:.1f} % at most\n", *evaluation.step,
                     100.0 * most);
}

std::string cell(const std::optional<double>& value) {
  return fmt::format("{:>14}", value ? fmt::format("{:.6g}", *value) : "-");
}

struct CommandOptions {
  EvaluateOptions evaluate;
  std::string test_layer;
  double reference_noise = 0.0;
  int step = 0;
  bool prints_json = false;
  std::string directory;
};

void add_inputs(CLI::App& command, CommandOptions& options) {
  command
      .add_option("-t,--test", options.evaluate.test, "Images to judge: A.####.exr, or one file")
      ->required();
  command.add_option("-r,--reference", options.evaluate.reference, "What they should be")
      ->required();
  command.add_option("--reference-b", options.evaluate.reference_b,
                     "Second, independent reference: takes the noise of both out of the figures");
  command.add_option("--reference-noise", options.reference_noise,
                     "relMSE of a single reference itself, subtracted from relmse");
  command
      .add_option("-l,--layer", options.evaluate.layer,
                  "Layer of the reference; \"\" or color: R, G, B")
      ->capture_default_str();
  command.add_option("--test-layer", options.test_layer,
                     "Layer of the test, if it has another name");
  command.add_option("--frames", options.evaluate.frames,
                     "Such as 40-59 or 1-10,20; without it all that are there");
  command.add_option("--step", options.step,
                     "Frame of a light step: also measure lag [what render wrote to the files]");
}

void add_outputs(CLI::App& command, CommandOptions& options) {
  command
      .add_option("--exposure", options.evaluate.metrics.exposure,
                  "Factor before the sRGB curve of PSNR, SSIM and tPSNR, and for flicker")
      ->capture_default_str();
  command.add_flag("--flicker", options.evaluate.metrics.measures_flicker,
                   "Also difference of consecutive frames; camera at rest only");
  command.add_flag("--skip-bad", options.evaluate.skips_bad,
                   "Leave out bad frames and pixels, and count them");
  command.add_flag("--json", options.prints_json, "Print JSON in place of the table");
  command.add_option("-o,--output", options.directory, "Directory for evaluate.json");
}

void run(const CLI::App& command, const CommandOptions& given, std::ostream& out) {
  EvaluateOptions options = given.evaluate;
  if (command.count("--test-layer") > 0) options.test_layer = given.test_layer;
  if (command.count("--reference-noise") > 0) {
    options.metrics.reference_noise = given.reference_noise;
  }
  if (command.count("--step") > 0) options.step = given.step;
  const Evaluation evaluation = evaluate(options);
  const std::string json = to_json(evaluation).dump(2) + "\n";
  if (!given.directory.empty()) {
    std::filesystem::create_directories(given.directory);
    write_file_atomically(std::filesystem::path(given.directory) / "evaluate.json",
                          std::string_view(json));
  }
  out << (given.prints_json ? json : to_table(evaluation)) << std::flush;
  if (!out) throw std::runtime_error("cannot write to standard output");
}

}  // namespace

nlohmann::ordered_json to_json(const Evaluation& evaluation) {
  Json json = {{"frames", evaluation.frames.size()}};
  json.update(to_json(evaluation.mean));
  if (evaluation.step) json["step"] = *evaluation.step;
  if (evaluation.lag) add_lag(*evaluation.lag, json["mean"]);
  json["surface_from"] = evaluation.surface_from;
  if (!evaluation.age_from.empty()) json["age_from"] = evaluation.age_from;
  json["bad_pixels"] = evaluation.bad_pixels;
  json["skipped"] = Json::array();
  for (const Skipped& skipped : evaluation.skipped) {
    json["skipped"].push_back({{"frame", skipped.frame}, {"reason", skipped.reason}});
  }
  json["per_frame"] = Json::array();
  for (const FrameFigures& frame : evaluation.frames) {
    Json& entry = json["per_frame"].emplace_back(to_json(frame));
    if (!evaluation.lag) continue;
    const auto reached = evaluation.lag->reached.find(frame.frame);
    if (reached != evaluation.lag->reached.end()) entry["step_reached"] = reached->second;
  }
  return json;
}

std::string to_table(const Evaluation& evaluation) {
  std::string text =
      fmt::format("{} frames; surface from {}", evaluation.frames.size(), evaluation.surface_from);
  if (!evaluation.age_from.empty()) text += fmt::format("; ages from {}", evaluation.age_from);
  text += fmt::format("\n\n{:<24}{:>14}{:>14}{:>14}\n", "", "all", "young", "old");
  text += fmt::format("{:<24}", "pixels");
  for (const Figures& set : evaluation.mean) text += fmt::format("{:>14}", set.pixels);
  text += '\n';
  for (std::size_t m = 0; m < kMetricCount; ++m) {
    if (!evaluation.mean[0].values[m]) continue;
    text += fmt::format("{:<24}", kMetricNames[m]);
    for (const Figures& set : evaluation.mean) text += cell(set.values[m]);
    text += '\n';
  }
  text += '\n' + lag_lines(evaluation);
  text += fmt::format("young: fewer than {} frames of history; - not measured\n", kYoungAge);
  text += evaluation.metrics.is_display
              ? std::string("values of 8-bit pictures as stored\n")
              : fmt::format("psnr, ssim, ms_ssim, tpsnr: of sRGB(clamp({} * value, 0, 1))\n",
                            evaluation.metrics.exposure);
  if (evaluation.bad_pixels > 0) {
    text += fmt::format("left out: {} pixels with NaN or Inf\n", evaluation.bad_pixels);
  }
  for (const Skipped& skipped : evaluation.skipped) {
    text += fmt::format("left out: frame {}: {}\n", skipped.frame, skipped.reason);
  }
  return text;
}

void add_evaluate_command(CLI::App& app, std::ostream& out) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure images against references: error, similarity, flicker");
  const auto options = std::make_shared<CommandOptions>();
  add_inputs(*command, *options);
  add_outputs(*command, *options);
  command->callback([command, options, &out] { run(*command, *options, out); });
}

}  // namespace eigenlight
