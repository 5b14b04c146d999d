// What commands that run for long share: threads, Ctrl-C, messages and progress.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sequences/cli/console.h"
#include "sequences/cli/interrupt.h"
#include "sequences/cli/progress.h"

namespace CLI {
class App;
}

namespace eigenlight {

struct JobOptions {
  int threads = 0;     ///< 0: one per core
  bool quiet = false;  ///< print errors only
  bool json = false;   ///< print the results as JSON
};

/// Adds --threads and -q, --quiet, and --json with that help text unless it is empty. `options`
/// must outlive `command`.
void add_job_options(CLI::App& command, JobOptions& options, const std::string& json_help = {});

/// A command was stopped by Ctrl-C, and has said so.
struct Interrupted {};

/// One run of a command. While it lives, Ctrl-C asks the command to stop. One at a time.
class Job {
 public:
  /// Sets the number of threads. Throws std::invalid_argument if it is out of range.
  Job(const JobOptions& options, const Console& console);

  /// Prints a line to the user, unless quiet.
  void say(std::string_view text) const;
  /// Prints the notes of a scene, each on a line.
  void say_notes(const std::vector<std::string>& notes) const;

  [[nodiscard]] bool interrupted() const { return interrupt_.interrupted(); }
  /// Does nothing before Ctrl-C; after it, says `text` and throws Interrupted.
  void stop_if_interrupted(std::string_view text) const;
  /// Says that what is complete is kept, and the command that goes on. Gives kInterrupted.
  [[nodiscard]] int stopped() const;

  /// A progress report of `total` frames, of which `done` were complete before.
  [[nodiscard]] Progress progress(std::size_t done, std::size_t total) const;

  /// Prints `json` with --json, nothing when quiet, else `text`.
  void print_results(std::string_view json, std::string_view text) const;

  /// The command line, quoted for a shell.
  [[nodiscard]] const std::string& command_line() const { return console_.command_line; }

 private:
  const JobOptions& options_;
  const Console& console_;
  InterruptGuard interrupt_;
};

}  // namespace eigenlight
