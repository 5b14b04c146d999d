#include "sequences/cli/compare_options.h"

#include <CLI/CLI.hpp>
#include <set>
#include <string>

#include "sequences/lab/paper.h"

namespace eigenlight {
namespace {

void add_what(CLI::App& command, CompareSettings& settings) {
  command.add_option("scenes", settings.scenes, "Built-in names, scene.json, .gltf, .glb or .obj");
  command.add_option("-o,--output", settings.directory, "Directory for results and page")
      ->required();
  command.add_option("--methods", settings.methods, "With commas [all of `eigenlight methods`]");
  command
      .add_option("--external", settings.external,
                  "NAME='command with {color} {albedo} {normal} {output} {frame}': a program "
                  "that reads and writes EXR, run for each frame; with {frames} once for all")
      ->allow_extra_args(false);
  command
      .add_option("--external-time", settings.external_time,
                  "NAME=REGEX: group 1 is the filter's milliseconds in what it prints [CPU time "
                  "of the program]")
      ->allow_extra_args(false);
  command.add_flag("--ablate", settings.ablate,
                   "Also our method without each of its parts; see `eigenlight methods --parts`");
  command.add_option("--perturb", settings.perturb, "What moves, with commas: none, lights, ...")
      ->capture_default_str();
  command.add_option("--spp", settings.spp, "Sample counts, with commas")->capture_default_str();
  command.add_flag("--environment", settings.environment,
                   "Environment map of a scene.json in place of its suns and sky");
}

void add_how(CLI::App& command, CompareSettings& settings) {
  command.add_option("--frames", settings.frames, "Frames to measure, without a gap")
      ->capture_default_str();
  command.add_option("--warmup", settings.warmup, "Frames before these, as far as there are any")
      ->capture_default_str();
  command.add_option("--size", settings.size, "Width and height in pixels")->capture_default_str();
  command.add_option("--bases", settings.bases, "Bases per pixel, 1 to 8")->capture_default_str();
  command.add_option("--bounces", settings.bounces, "Bounces of indirect light")
      ->capture_default_str();
  command.add_option("--seed", settings.seed, "Other seeds, other noise")->capture_default_str();
  command
      .add_option("--reference-spp", settings.reference_spp, "Samples of both references together")
      ->capture_default_str();
  command.add_option("--cache", settings.cache, "Directory for references")->capture_default_str();
  command.add_option(
      "--equal-time", settings.equal_time,
      "Milliseconds a frame at which errors are compared [ours at the lowest --spp]");
}

// Papers come with scenes, methods and sample counts of their own.
void add_paper(CLI::App& command, CompareSettings& settings) {
  CLI::Option* paper =
      command.add_option("--paper", settings.paper,
                         "In place of scenes: measure again what a paper claims; " + paper_names());
  for (CLI::Option* other : command.get_options()) {
    static const std::set<std::string> kShared{"--help",   "--paper",   "--output", "--size",
                                               "--frames", "--threads", "--quiet",  "--json"};
    const std::string name = other->get_name();
    if (!kShared.contains(name)) paper->excludes(other);
  }
  command.parse_complete_callback([&command, &settings] {
    if (settings.paper.empty()) {
      if (settings.scenes.empty()) throw CLI::RequiredError("scenes or --paper");
      return;
    }
    if (command.get_option("--size")->count() == 0) settings.size.clear();
    if (command.get_option("--frames")->count() == 0) settings.frames.clear();
  });
}

}  // namespace

void add_compare_options(CLI::App& command, CompareOptions& options) {
  add_what(command, options.settings);
  add_how(command, options.settings);
  add_job_options(command, options.job, "Print results.json instead of the table");
  add_paper(command, options.settings);
}

}  // namespace eigenlight
