#include "sequences/cli/job.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "frame/tiles.h"
#include "sequences/cli/command.h"

namespace eigenlight {

void add_job_options(CLI::App& command, JobOptions& options, const std::string& json_help) {
  command.add_option("--threads", options.threads, "Number of threads; 0: one per core")
      ->capture_default_str();
  command.add_flag("-q,--quiet", options.quiet, "Print errors only");
  if (!json_help.empty()) command.add_flag("--json", options.json, json_help);
}

Job::Job(const JobOptions& options, const Console& console)
    : options_(options),
      console_(console),
      interrupt_(options.quiet ? InterruptGuard::Notice::kSilent
                               : InterruptGuard::Notice::kStderr) {
  set_thread_count(options.threads);
}

void Job::say(std::string_view text) const {
  if (!options_.quiet) console_.err << text << '\n' << std::flush;
}

void Job::say_notes(const std::vector<std::string>& notes) const {
  for (const std::string& note : notes) say("eigenlight: note: " + note);
}

void Job::stop_if_interrupted(std::string_view text) const {
  if (!interrupted()) return;
  say(text);
  throw Interrupted();
}

Progress Job::progress(std::size_t done, std::size_t total) const {
  const auto style = options_.quiet             ? Progress::Style::kNone
                     : console_.err_is_terminal ? Progress::Style::kBar
                                                : Progress::Style::kLines;
  return {console_.err, style, done, total};
}

void Job::print_results(std::string_view json, std::string_view text) const {
  if (options_.json) {
    console_.out << json << std::flush;
  } else if (!options_.quiet) {
    console_.out << text << std::flush;
  }
}

int Job::stopped() const {
  say(fmt::format("stopped; what is complete is kept; to go on:\n  {}", command_line()));
  return kInterrupted;
}

}  // namespace eigenlight
