#include "sequences/cli/denoise_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "sequences/cli/job.h"
#include "sequences/cli/layer_options.h"
#include "sequences/denoise/denoise_page.h"
#include "sequences/denoise/plan_text.h"
#include "sequences/files/directory.h"

namespace eigenlight {
namespace {

struct DenoiseCommand {
  DenoiseSettings settings;
  bool dry_run = false, page = false;
  JobOptions job;
};

void add_file_options(CLI::App& command, DenoiseCommand& options) {
  FileChoice& files = options.settings.files;
  command
      .add_option("input", files.inputs,
                  "EXR files: a pattern such as shot.####.exr, or a file; several for frames whose "
                  "layers lie in several files")
      ->required();
  command
      .add_option("-o,--output", files.output,
                  "Folder for files of the same names; or a pattern, or a file, that ends in .exr")
      ->required();
  command.add_option("--frames", files.frames, "Such as 7, 1-24 or 1-100x5 [all that exist]");
  command
      .add_option("--lookahead", options.settings.lookahead,
                  "How many later frames may help a frame; 0: none")
      ->check(CLI::Range(0, kMostLookahead))
      ->capture_default_str();
  command.add_option("--max-memory", options.settings.max_memory,
                     "Such as 8G: look ahead no farther than fits [four fifths of the machine's]");
  command.add_flag("--overwrite", files.overwrite, "Allow that an output is an input");
  command.add_flag("--skip-existing", options.settings.skip_existing,
                   "Do not write frames again whose output is complete");
  command.add_flag("--resume", options.settings.resume, "Go on where an interrupted run stopped");
  command
      .add_option("--checkpoint", options.settings.checkpoint_seconds,
                  "Seconds between checkpoints, which hold the whole history")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command.add_flag("--page", options.page,
                   "Write page/index.html beside the outputs: noisy beside denoised frames, "
                   "layers, times");
  command.add_flag("--dry-run", options.dry_run,
                   "Print what would be done with each layer, and stop");
}

int denoise(const DenoiseCommand& command, const Console& console) {
  const Job job(command.job, console);
  const DenoisePlan plan = plan_denoising(command.settings);
  if (command.dry_run) {
    job.print_results(to_json(plan), to_text(plan));
    return kSuccess;
  }
  // A folder that cannot be made is told before the first frame is denoised.
  for (const auto& output : plan.frames.front().outputs) {
    if (output.has_parent_path()) make_directory(output.parent_path());
  }
  job.say(to_text(plan));
  Progress progress = job.progress(0, plan.frames.size());
  DenoiseCallbacks callbacks{[&] { return job.interrupted(); },
                             [&](int frame) { progress.frame_done(frame); }};
  std::optional<DenoiseLog> log;
  if (command.page) {
    make_directory(denoise_page_folder(plan));
    log.emplace(denoise_page_folder(plan) / "frames.jsonl", command.settings.resume);
    callbacks.record = [&](const DenoiseRecord& record) { log->append(record); };
  }
  const DenoiseTotals totals = run_denoising(command.settings, plan, callbacks);
  progress.finish();
  job.stop_if_interrupted(fmt::format("stopped after {} of {} frames; to go on:\n  {}{}",
                                      totals.frames, plan.frames.size(), job.command_line(),
                                      command.settings.resume ? "" : " --resume"));
  if (command.page) {
    write_denoise_page(plan, totals);
    job.say((denoise_page_folder(plan) / "index.html").string());
  }
  job.print_results(to_json(totals), to_text(totals));
  return kSuccess;
}

}  // namespace

Command add_denoise_command(CLI::App& app) {
  CLI::App* parser =
      app.add_subcommand("denoise",
                         "Denoise EXR sequences of any renderer: the same files with "
                         "clean light");
  const auto command = std::make_shared<DenoiseCommand>();
  add_file_options(*parser, *command);
  DenoiseSettings& settings = command->settings;
  add_layer_options(*parser, settings.layers, settings.guides, settings.cuts);
  add_job_options(*parser, command->job, "Print the plan or the summary as JSON");
  return {parser, [command](const Console& console) { return denoise(*command, console); }};
}

}  // namespace eigenlight
