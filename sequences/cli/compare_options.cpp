#include "sequences/cli/compare_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <set>
#include <string>

#include "sequences/cli/layer_options.h"
#include "sequences/cli/markdown_option.h"
#include "sequences/compare/recorded_plan.h"
#include "sequences/lab/paper.h"

namespace eigenlight {
namespace {

constexpr int kAllBefore = 20'000'000;  // more frames than numbers of frames can differ by

void add_what(CLI::App& command, CompareSettings& settings) {
  command.add_option("scenes", settings.scenes,
                     "Built-in names, scene.json, .gltf, .glb or .obj; SCENE:PERTURB with commas "
                     "names what moves in that scene; or EXR patterns, shot.####.exr: the files of "
                     "one recorded shot");
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
  command
      .add_option("--perturb", settings.perturb,
                  "What moves, with commas: none, lights, ...; of scenes that do not say it")
      ->capture_default_str();
  command.add_option("--aa", settings.antialias,
                     "In place of methods: ways of antialiasing, with commas, as in `render --aa` "
                     "[--spp 24 --frames 20 --warmup 1 --reference-spp 512]");
  command.add_option("--layer", settings.layer,
                     "What is measured: indirect or color of scenes [indirect], any layer of "
                     "recorded frames [beauty]");
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
  command.add_option("--crop", settings.crop,
                     "WIDTHxHEIGHT+X+Y: write crops-SCENE.jpg with this crop of every method");
  command.add_option("--crops-per-row", settings.crops_per_row, "0: all in one row")
      ->capture_default_str();
  add_markdown_option(command, settings.markdown);
}

// Of recorded frames.
void add_recorded(CLI::App& command, CompareSettings& settings) {
  command.add_option("--reference", settings.reference,
                     "Recorded frames: reference, shot.ref.####.exr; with :NAME the layers NAME.*");
  command.add_option("--reference-b", settings.reference_b,
                     "Recorded frames: second, independent reference");
  add_layer_options(command, settings.layers, settings.guides, settings.cuts);
}

constexpr std::array kOfRecorded{"--reference", "--reference-b", "--map",    "--keep",
                                 "--skip",      "--motion",      "--camera", "--cuts"};
constexpr std::array kOfScenes{"--perturb", "--aa",      "--spp",           "--environment",
                               "--size",    "--seed",    "--reference-spp", "--cache",
                               "--bases",   "--bounces", "--equal-time",    "--ablate"};

// Scenes are rendered, recorded frames are read.
void check_kind(const CLI::App& command, bool is_recorded) {
  for (const char* option : kOfScenes) {
    if (!is_recorded || command.get_option(option)->count() == 0) continue;
    throw CLI::ValidationError(fmt::format("{} is for scenes, not for recorded frames", option));
  }
  for (const char* option : kOfRecorded) {
    if (is_recorded || command.get_option(option)->count() == 0) continue;
    throw CLI::ValidationError(
        fmt::format("{} is for recorded frames, such as shot.####.exr", option));
  }
}

// Papers come with scenes, methods and sample counts of their own.
void add_paper(CLI::App& command, CompareSettings& settings) {
  CLI::Option* paper =
      command.add_option("--paper", settings.paper,
                         "In place of scenes: measure again what a paper claims; " + paper_names());
  for (CLI::Option* other : command.get_options()) {
    static const std::set<std::string> kShared{"--help",  "--paper",  "--output",
                                               "--size",  "--frames", "--threads",
                                               "--quiet", "--json",   "--markdown"};
    const std::string name = other->get_name();
    if (!kShared.contains(name)) paper->excludes(other);
  }
}

// Antialiasing is measured on single frames of many samples.
void add_antialias(CLI::App& command) {
  CLI::Option* antialias = command.get_option("--aa");
  for (const char* other :
       {"--methods", "--external", "--external-time", "--ablate", "--equal-time"}) {
    antialias->excludes(command.get_option(other));
  }
}

// Defaults that depend on what is compared.
void set_defaults(const CLI::App& command, CompareSettings& settings) {
  const auto is_given = [&](const char* option) { return command.get_option(option)->count() > 0; };
  if (!settings.paper.empty()) {
    if (!is_given("--size")) settings.size.clear();
    if (!is_given("--frames")) settings.frames.clear();
    return;
  }
  if (settings.scenes.empty()) throw CLI::RequiredError("scenes or --paper");
  check_kind(command, is_recorded(settings));
  if (is_recorded(settings)) {
    if (!is_given("--frames")) settings.frames.clear();
    if (!is_given("--warmup")) settings.warmup = kAllBefore;
  }
  if (settings.antialias.empty()) return;
  if (!is_given("--spp")) settings.spp = "24";
  if (!is_given("--frames")) settings.frames = "20";
  if (!is_given("--warmup")) settings.warmup = 1;
  if (!is_given("--reference-spp")) settings.reference_spp = 512;
}

}  // namespace

void add_compare_options(CLI::App& command, CompareOptions& options) {
  add_what(command, options.settings);
  add_how(command, options.settings);
  add_recorded(command, options.settings);
  add_job_options(command, options.job, "Print results.json instead of the table");
  add_paper(command, options.settings);
  add_antialias(command);
  command.parse_complete_callback(
      [&command, &options] { set_defaults(command, options.settings); });
}

}  // namespace eigenlight
