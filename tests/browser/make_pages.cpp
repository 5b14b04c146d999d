// make_pages KIND DIR: writes DIR/index.html, a page of invented results.
//   run-N    a run of N frames
//   compare  a comparison of two scenes
//   denoise  `denoise` over five frames of a painted wall, three of whose pixels are NaN in each
//   paper    a paper with one claim, a table and two plots
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numeric>
#include <string>

#include "sequences/denoise/denoise_page.h"
#include "sequences/files/atomic_file.h"
#include "sequences/lab/paper.h"
#include "sequences/pages/run_page.h"
#include "tests/support/fake_comparison.h"
#include "tests/support/fake_run.h"
#include "tests/support/fake_shot.h"

namespace eigenlight {
namespace {

void make_run(const std::filesystem::path& dir, int frames) {
  FakeRun run{.title = "A <made-up> room & its \"light\"", .extent = {320, 180}};
  run.frames.resize(static_cast<std::size_t>(frames));
  std::iota(run.frames.begin(), run.frames.end(), 0);
  write_fake_run(dir, run);
  write_run_page(dir);
}

Page comparison() {
  ComparePlan plan = fake_plan({1, 2, 4, 8});
  plan.contenders.push_back({"eigenlight-without-budget", "eigenlight", "budget", {}});
  Page page = compare_page(plan, {fake_results(plan, "room"), fake_results(plan, "hall")},
                           {fake_gallery(plan), fake_gallery(plan)});
  // An error without the noise of the references may be negative, and has no logarithm.
  page.sections[0].plots[1].series[1].points[1].y = -1e-4;
  return page;
}

// Writes the page itself, to DIR/index.html.
void make_denoised(const std::filesystem::path& dir) {
  FakeShot shot;
  shot.nan_pixels = 3;
  for (int frame = 1; frame <= 5; ++frame) {
    shot.write(dir / ("s.000" + std::to_string(frame) + ".exr"), frame);
  }
  DenoiseSettings settings;
  settings.files.inputs = {(dir / "s.####.exr").string()};
  settings.files.output = dir / "out";
  const DenoisePlan plan = plan_denoising(settings);
  std::filesystem::create_directories(denoise_page_folder(plan));
  DenoiseLog log(denoise_page_folder(plan) / "frames.jsonl", false);
  const DenoiseCallbacks callbacks{[] { return false; }, [](int) {},
                                   [&](const DenoiseRecord& record) { log.append(record); }};
  write_file_atomically(dir / "index.html",
                        to_html(denoise_page(plan, run_denoising(settings, plan, callbacks))));
}

Page paper() {
  PaperReport report;
  report.claims = {{"Table 1", "the filter is fast", "1 ms", "2 ms", Verdict::kInPart},
                   {"Fig. 2", "the error falls", "in words", "3 of 3", Verdict::kHeld}};
  PageTable table{"times", "", "size", {{"ms"}, {"words"}}, {}};
  table.rows = {{"8x8", {2.5, std::string("few")}}, {"64x64", {12345678.0, std::string("many")}}};
  PagePlot linear{"error", "falls", {"samples"}, {"MSE"}, {}};
  linear.series = {{"ours", {{1.0, 0.5}, {2.0, 0.25}, {4.0, 0.1}}},
                   {"theirs", {{1.0, 0.6}, {2.0, 0.5}, {4.0, 0.45}}}};
  PagePlot log{"time", "", {"pixels", true}, {"ms", true}, linear.series};
  report.sections = {{"Table 1", "", {linear, log}, {table}, {}}};
  const PaperRun run{{8, 4}, {0, 1, 2}, {}};
  return paper_page(papers().front(), run, report);
}

int make(const std::string& kind, const std::filesystem::path& dir) {
  std::filesystem::create_directories(dir);
  if (kind.starts_with("run-")) {
    make_run(dir, std::atoi(kind.c_str() + 4));
  } else if (kind == "denoise") {
    make_denoised(dir);
  } else if (kind == "compare" || kind == "paper") {
    write_file_atomically(dir / "index.html", to_html(kind == "paper" ? paper() : comparison()));
  } else {
    std::fprintf(stderr, "make_pages: unknown kind \"%s\"\n", kind.c_str());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace eigenlight

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: make_pages run-N|denoise|compare|paper DIR\n", stderr);
    return 2;
  }
  try {
    return eigenlight::make(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_pages: %s\n", error.what());
    return 1;
  }
}
