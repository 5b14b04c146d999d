#include "sequences/cli/cli.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <string>

#include "sequences/cli/compare_command.h"
#include "sequences/cli/compare_options.h"
#include "sequences/cli/evaluate_command.h"
#include "sequences/cli/judge_pyramid_command.h"
#include "sequences/cli/list_commands.h"
#include "sequences/cli/render_command.h"
#include "sequences/cli/stress_command.h"
#include "sequences/cli/train_pyramid_command.h"
#include "sequences/files/checkpoint.h"
#include "sequences/files/shell_quote.h"
#include "sequences/files/version.h"

namespace eigenlight {
namespace {

constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

void add_picture_options(CLI::App& command, RenderSettings& settings) {
  // Scripts put a user's options behind their own.
  command.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  command
      .add_option("scene", settings.scene,
                  "Built-in name (see `eigenlight scenes`), scene.json, .gltf, .glb or .obj")
      ->required();
  command.add_option("-o,--output", settings.directory, "Directory for frames, logs and page")
      ->required();
  command.add_option("--frames", settings.frames, "Such as 7, 0-47, 5-1, 1-100x5 or 1-9,20")
      ->capture_default_str();
  command.add_option("--size", settings.size, "Width and height in pixels")->capture_default_str();
  command.add_option("--spp", settings.spp,
                     "Samples of indirect light per pixel [3; reference: 512]");
  command.add_option("--bounces", settings.bounces, "Bounces of indirect light")
      ->capture_default_str();
  command.add_option("--seed", settings.seed, "Other seeds, other noise")->capture_default_str();
  command
      .add_option("--perturb", settings.perturb,
                  "What changes: none, lights, objects, all, step[:FRAME] (light, once)")
      ->capture_default_str();
  command.add_flag("--environment", settings.environment,
                   "Environment map of a scene.json in place of its suns and sky");
}

void add_run_options(CLI::App& command, RenderSettings& settings) {
  command.add_option("--method", settings.method,
                     fmt::format("See `eigenlight methods` [{}]", default_method()));
  command.add_option("--without", settings.without,
                     "Parts of the method to turn off, with commas; see `eigenlight methods "
                     "--parts`");
  command.add_option("--bases", settings.bases, "Bases per pixel, 1 to 8")->capture_default_str();
  command
      .add_option(
          "--aa", settings.antialias,
          "Antialiasing of the layer color: none, lookup, sraa, sraa-geometry, supersample:N")
      ->capture_default_str();
  command.add_option("--layers", settings.layers,
                     "Layers to write, with commas [all]: " + format_layers(parse_layers("")));
  command.add_option("--threads", settings.threads, "0: one per core")->capture_default_str();
  command.add_flag("--resume", settings.resume, "Go on where an interrupted run stopped");
  command.add_flag("-q,--quiet", settings.quiet, "Print errors only");
  command.add_flag("--json", settings.json, "Print the summary as JSON");
}

CLI::App* add_stress_options(CLI::App& app, StressSettings& settings) {
  CLI::App* command =
      app.add_subcommand("stress", "Try everything that must not break the denoiser");
  command->add_flag("--json", settings.json, "Print JSON in place of the table");
  command->add_flag("--long", settings.takes_long, "Also the cases that take minutes");
  command->add_option("--case", settings.only, "One case, or one theme such as values");
  command->add_option("--seed", settings.seed, "Other seeds, other noise")->capture_default_str();
  command->add_option("-o,--output", settings.directory, "Directory for what failing cases leave")
      ->capture_default_str();
  return command;
}

// CLI11 explains over several lines at times; one is enough.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

int parse_and_run(std::span<const char* const> args, const Console& console) {
  CLI::App app("Temporal denoising of path-traced indirect light", "eigenlight");
  app.set_version_flag("--version", program_version());
  app.require_subcommand(1);
  RenderSettings settings;
  CLI::App* render = app.add_subcommand("render", "Render and denoise a flythrough");
  add_picture_options(*render, settings);
  add_run_options(*render, settings);
  const CLI::App* scenes = app.add_subcommand("scenes", "List the built-in scenes");
  CLI::App* methods = app.add_subcommand("methods", "List the methods");
  bool lists_parts = false;
  methods->add_flag("--parts", lists_parts, "List the parts that --without can turn off");
  add_evaluate_command(app, console.out);
  add_train_pyramid_command(app, console);
  add_judge_pyramid_command(app, console);
  CompareSettings compare_settings;
  const CLI::App* compare = add_compare_command(app, compare_settings);
  StressSettings stress_settings;
  const CLI::App* stress = add_stress_options(app, stress_settings);
  try {
    app.parse(static_cast<int>(args.size()), args.data());
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version, console.out, console.err);
  } catch (const CLI::RequiredError& error) {
    // Of a word that is no command CLI11 only says that a command is missing.
    const bool names_none = app.get_subcommands().empty();
    const std::string what = names_none && args.size() > 1
                                 ? fmt::format("unknown command '{}'", args[1])
                                 : one_line(error.what());
    console.err << fmt::format("eigenlight: {}; see eigenlight --help\n", what);
    return kBadUsage;
  } catch (const CLI::ParseError& error) {
    console.err << fmt::format("eigenlight: {}; see eigenlight --help\n", one_line(error.what()));
    return kBadUsage;
  }
  if (scenes->parsed()) list_scenes(console.out);
  if (methods->parsed()) (lists_parts ? list_parts : list_methods)(console.out);
  if (compare->parsed()) return compare_command(compare_settings, console);
  if (stress->parsed()) return stress_command(stress_settings, console);
  return render->parsed() ? render_command(settings, console) : 0;
}

}  // namespace

int run_command_line(std::span<const char* const> args, Console console) {
  for (const char* word : args) {
    if (!console.command_line.empty()) console.command_line += ' ';
    console.command_line += quote_for_shell(word);
  }
  const auto fail = [&](const std::string& what, int status) {
    console.err << "eigenlight: " << one_line(what) << '\n' << std::flush;
    return status;
  };
  try {
    return parse_and_run(args, console);
  } catch (const std::invalid_argument& error) {
    return fail(error.what(), kBadUsage);
  } catch (const CheckpointError& error) {
    return fail(error.what(), kBadUsage);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kFailed);
  } catch (const std::exception& error) {
    return fail(error.what(), kFailed);
  }
}

}  // namespace eigenlight
