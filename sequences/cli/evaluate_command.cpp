#include "sequences/cli/evaluate_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "sequences/files/atomic_file.h"
#include "sequences/files/directory.h"
#include "sequences/metrics/evaluate.h"
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

Json to_json(const Evaluation& evaluation) {
  Json json = {{"frames", evaluation.frames.size()}};
  json.update(to_json(evaluation.mean));
  if (evaluation.step) json["step"] = *evaluation.step;
  if (evaluation.lag) add_lag(*evaluation.lag, json["mean"]);
  json["surface_from"] = evaluation.surface_from;
  if (!evaluation.age_from.empty()) json["age_from"] = evaluation.age_from;
  json["bad_pixels"] = evaluation.bad_pixels;
  json["outside_pixels"] = evaluation.outside_pixels;
  json["notes"] = evaluation.notes;
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
  text += fmt::format("{:<24}", "energy");
  for (const Figures& set : evaluation.mean) text += cell(set.energy());
  text += '\n';
  text += '\n' + lag_lines(evaluation);
  text += fmt::format(
      "energy: light / reference_light; young: fewer than {} frames of history; - "
      "not measured\n",
      kYoungAge);
  text += evaluation.metrics.is_display
              ? std::string("values of 8-bit pictures as stored\n")
              : fmt::format("psnr, ssim, ms_ssim, tpsnr: of sRGB(clamp({} * value, 0, 1))\n",
                            evaluation.metrics.exposure);
  if (evaluation.bad_pixels > 0) {
    text += fmt::format("left out: {} pixels with NaN or Inf\n", evaluation.bad_pixels);
  }
  if (evaluation.outside_pixels > 0) {
    text += fmt::format("left out: {} pixels outside the data window\n", evaluation.outside_pixels);
  }
  for (const std::string& note : evaluation.notes) text += fmt::format("note: {}\n", note);
  for (const Skipped& skipped : evaluation.skipped) {
    text += fmt::format("left out: frame {}: {}\n", skipped.frame, skipped.reason);
  }
  return text;
}

struct EvaluateCommand {
  EvaluateOptions evaluate;
  bool json = false;
  std::string directory;
};

void add_inputs(CLI::App& command, EvaluateOptions& options) {
  command
      .add_option("-t,--test", options.test,
                  "Images to measure: a pattern such as A.####.exr, or one file")
      ->required();
  command
      .add_option("-r,--reference", options.reference,
                  "Images of the truth: a pattern, or one file; NAME.exr:HalfA for layers HalfA.*")
      ->required();
  command.add_option("--reference-b", options.reference_b,
                     "Second, independent reference; removes the noise of both references from "
                     "the figures");
  command.add_option("--reference-noise", options.metrics.reference_noise,
                     "relMSE of a single reference, subtracted from relmse");
  command.add_option("-l,--layer", options.layer,
                     "Layer of the reference; \"\" or color: R, G, B or the beauty [indirect, or "
                     "the beauty of files that have none]");
  command.add_option("--test-layer", options.test_layer,
                     "Layer of the test, if its name differs from --layer");
  command.add_option("--frames", options.frames, "Such as 40-59 or 1-10,20 [all that exist]");
  command.add_option("--step", options.step,
                     "Frame of a light step: also measure lag [as the files say]");
}

void add_outputs(CLI::App& command, EvaluateCommand& options) {
  MetricOptions& metrics = options.evaluate.metrics;
  command
      .add_option("--exposure", metrics.exposure,
                  "Factor before the sRGB curve of PSNR, SSIM and tPSNR, and for flicker")
      ->capture_default_str();
  command.add_flag("--flicker", metrics.measures_flicker,
                   "Also measure the difference of consecutive frames; for a camera at rest");
  command.add_flag("--skip-bad", options.evaluate.skips_bad,
                   "Leave out and count bad frames and pixels");
  command.add_flag("--json", options.json, "Print JSON instead of the table");
  command.add_option("-o,--output", options.directory, "Directory for evaluate.json");
}

int run(const EvaluateCommand& command, const Console& console) {
  const Evaluation evaluation = evaluate(command.evaluate);
  const std::string json = to_json(evaluation).dump(2) + "\n";
  if (!command.directory.empty()) {
    make_directory(command.directory);
    write_file_atomically(std::filesystem::path(command.directory) / "evaluate.json", json);
  }
  console.out << (command.json ? json : to_table(evaluation));
  return kSuccess;
}

}  // namespace

Command add_evaluate_command(CLI::App& app) {
  CLI::App* parser = app.add_subcommand(
      "evaluate", "Measure images against references: error, similarity, flicker");
  const auto command = std::make_shared<EvaluateCommand>();
  add_inputs(*parser, command->evaluate);
  add_outputs(*parser, *command);
  return {parser, [command](const Console& console) { return run(*command, console); }};
}

}  // namespace eigenlight
