#include "sequences/cli/cli.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "frame/bad_file.h"
#include "sequences/cli/command.h"
#include "sequences/cli/compare_command.h"
#include "sequences/cli/denoise_command.h"
#include "sequences/cli/evaluate_command.h"
#include "sequences/cli/job.h"
#include "sequences/cli/judge_pyramid_command.h"
#include "sequences/cli/list_commands.h"
#include "sequences/cli/render_command.h"
#include "sequences/cli/stress_command.h"
#include "sequences/cli/train_pyramid_command.h"
#include "sequences/files/shell_quote.h"
#include "sequences/files/version.h"

namespace eigenlight {
namespace {

// In the order of `eigenlight --help`.
constexpr Command (*kCommands[])(CLI::App&) = {
    add_render_command,  add_denoise_command,       add_scenes_command,
    add_methods_command, add_evaluate_command,      add_compare_command,
    add_stress_command,  add_train_pyramid_command, add_judge_pyramid_command,
};

// Errors of CLI11 may span lines.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

int fail(const Console& console, const std::string& what, ExitStatus status) {
  console.err << "eigenlight: " << one_line(what) << '\n' << std::flush;
  return status;
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error,
                        std::span<const char* const> args) {
  // CLI11 reports an unknown sub-command as a missing one.
  const bool is_unknown = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr &&
                          app.get_subcommands().empty() && args.size() > 1;
  const auto chosen = app.get_subcommands();
  std::string what =
      is_unknown ? fmt::format("unknown command '{}'", args[1]) : one_line(error.what());
  // CLI11 lists them backwards, and those in front of a command after what the command lacks.
  const std::vector<std::string> early = app.remaining(false), all = app.remaining(true);
  if (!chosen.empty() && !early.empty()) {
    what = fmt::format("not expected before '{}': {}; options follow the command",
                       chosen.front()->get_name(), fmt::join(early, " "));
  } else if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    what = fmt::format("not expected: {}", fmt::join(all, " "));
  }
  return fmt::format("{}; see eigenlight {}--help", what,
                     chosen.empty() ? "" : chosen.front()->get_name() + " ");
}

// The exit status if the command line asks for help or is wrong; nothing if a command is to be run.
std::optional<int> parse(CLI::App& app, std::span<const char* const> args, const Console& console) {
  try {
    app.parse(static_cast<int>(args.size()), args.data());
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version, console.out, console.err);
  } catch (const CLI::ParseError& error) {
    return fail(console, usage_error(app, error, args), kBadInput);
  }
  return std::nullopt;
}

int parse_and_run(std::span<const char* const> args, const Console& console) {
  CLI::App app("Temporal denoising of path-traced indirect light", "eigenlight");
  app.set_version_flag("--version", program_version());
  app.require_subcommand(1);
  // Scripts append a user's options to their own.
  app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  std::vector<Command> commands;
  for (const auto add : kCommands) commands.push_back(add(app));
  if (const std::optional<int> status = parse(app, args, console)) return *status;
  for (const Command& command : commands) {
    if (command.parser->parsed()) return command.run(console);
  }
  throw std::logic_error("a command line without a sub-command was accepted");
}

}  // namespace

int run_command_line(std::span<const char* const> args, Console console) {
  for (const char* word : args) {
    if (!console.command_line.empty()) console.command_line += ' ';
    console.command_line += quote_for_shell(word);
  }
  try {
    const int status = parse_and_run(args, console);
    if (!console.out.flush()) throw std::runtime_error("cannot write to standard output");
    return status;
  } catch (const Interrupted&) {
    return kInterrupted;
  } catch (const std::invalid_argument& error) {
    return fail(console, error.what(), kBadInput);
  } catch (const BadFile& error) {
    return fail(console, error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return fail(console, "out of memory", kFailed);
  } catch (const std::exception& error) {
    return fail(console, error.what(), kFailed);
  }
}

}  // namespace eigenlight
