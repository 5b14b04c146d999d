#include "sequences/cli/compare_paper.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "sequences/cli/markdown_option.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/directory.h"
#include "sequences/files/frame_range.h"
#include "sequences/lab/paper.h"
#include "sequences/runs/render_plan.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFrames = "0-23";  // one second
// Results are means over the last frames, which need frames before them.
constexpr std::size_t kLeastFrames = 8;

PaperRun make_run(const Paper& paper, const CompareSettings& settings) {
  PaperRun run;
  run.extent = parse_size(settings.size.empty() ? std::string(paper.size) : settings.size);
  const std::string frames = settings.frames.empty() ? kFrames : settings.frames;
  run.frames = parse_frame_range(frames);
  const bool is_run =
      run.frames.back() - run.frames.front() + 1 == static_cast<int>(run.frames.size());
  if (!is_run || run.frames.size() < kLeastFrames) {
    throw std::invalid_argument(
        fmt::format("frames '{}': expected {} or more frames, ascending and without a gap", frames,
                    kLeastFrames));
  }
  return run;
}

}  // namespace

int compare_paper(const CompareSettings& settings, const Job& job) {
  const Paper& paper = find_paper(settings.paper);
  PaperRun run = make_run(paper, settings);
  const fs::path directory = settings.directory;
  make_directory(directory);
  run.step = [&](const std::string& what) {
    job.stop_if_interrupted("stopped; nothing was written");
    job.say(fmt::format("{}: {}", paper.name, what));
  };
  const PaperReport report = paper.rerun(run);
  const std::string json = paper_json(paper, run, report);
  const fs::path page = directory / "index.html";
  write_file_atomically(directory / "results.json", json);
  write_file_atomically(page, to_html(paper_page(paper, run, report)));
  const std::string markdown = to_markdown(paper, run, report);
  write_markdown(settings.markdown, markdown);
  job.print_results(json, is_printed(settings.markdown)
                              ? markdown
                              : fmt::format("{}\n{}\n", markdown, page.string()));
  return kSuccess;
}

}  // namespace eigenlight
