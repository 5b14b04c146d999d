#include "sequences/cli/paper_command.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "frame/tiles.h"
#include "sequences/cli/interrupt.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/frame_range.h"
#include "sequences/lab/paper.h"
#include "sequences/runs/render_plan.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// A second.
constexpr const char* kFrames = "0-23";
// Figures are means over the last frames, and need some before them.
constexpr std::size_t kLeastFrames = 8;

struct Interrupted {};

PaperRun make_run(const Paper& paper, const CompareSettings& settings) {
  PaperRun run;
  run.extent = parse_size(settings.size.empty() ? std::string(paper.size) : settings.size);
  const std::string frames = settings.frames.empty() ? kFrames : settings.frames;
  run.frames = parse_frame_range(frames);
  const bool is_run =
      run.frames.back() - run.frames.front() + 1 == static_cast<int>(run.frames.size());
  if (!is_run || run.frames.size() < kLeastFrames) {
    throw std::invalid_argument(
        fmt::format("--frames {}: expected {} or more frames, ascending and without a gap", frames,
                    kLeastFrames));
  }
  return run;
}

fs::path make_directory(const std::string& name) {
  std::error_code error;
  fs::create_directories(name, error);
  if (fs::is_directory(name)) return name;
  throw std::runtime_error(fmt::format("{}: cannot make the directory: {}", name,
                                       error ? error.message() : "Not a directory"));
}

}  // namespace

int paper_command(const CompareSettings& settings, const Console& console) {
  const Paper& paper = find_paper(settings.paper);
  PaperRun run = make_run(paper, settings);
  const fs::path directory = make_directory(settings.directory);
  const InterruptGuard interrupt(settings.quiet ? InterruptGuard::Notice::kSilent
                                                : InterruptGuard::Notice::kStderr);
  set_thread_count(settings.threads);
  run.step = [&](const std::string& what) {
    if (interrupt.interrupted()) throw Interrupted();
    if (!settings.quiet) console.err << fmt::format("{}: {}\n", paper.name, what) << std::flush;
  };
  PaperReport report;
  try {
    report = paper.rerun(run);
  } catch (const Interrupted&) {
    if (!settings.quiet) console.err << "stopped; nothing was written\n" << std::flush;
    return kInterruptedStatus;
  }
  const std::string json = paper_json(paper, run, report);
  write_file_atomically(directory / "results.json", json);
  write_file_atomically(directory / "index.html", to_html(paper_page(paper, run, report)));
  if (settings.json) {
    console.out << json << std::flush;
  } else if (!settings.quiet) {
    console.out << to_markdown(paper, report) << '\n'
                << (directory / "index.html").string() << '\n'
                << std::flush;
  }
  return 0;
}

}  // namespace eigenlight
