// make_page DIR FRAMES: the report of a made-up run, for the test in a browser.
#include <cstdlib>
#include <numeric>

#include "sequences/pages/report.h"
#include "tests/support/fake_run.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  eigenlight::FakeRun run{.title = "A <made-up> room & its \"light\"", .extent = {320, 180}};
  run.frames.resize(static_cast<std::size_t>(std::atoi(argv[2])));
  std::iota(run.frames.begin(), run.frames.end(), 0);
  eigenlight::write_fake_run(argv[1], run);
  eigenlight::write_report(argv[1]);
}
