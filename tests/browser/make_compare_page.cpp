// make_compare_page FILE: the page of a made-up comparison, for the test in a browser.
#include "sequences/files/atomic_file.h"
#include "tests/support/fake_comparison.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  using namespace eigenlight;
  ComparePlan plan = fake_plan({1, 2, 4, 8});
  plan.contenders.push_back({"eigenlight-without-budget", "eigenlight", "budget", {}});
  Page page = compare_page(plan, {fake_results(plan, "room"), fake_results(plan, "hall")},
                           {fake_gallery(plan), fake_gallery(plan)});
  // Errors without noise may be below 0, and have no place on a logarithmic axis.
  page.sections[0].plots[1].series[1].points[1].y = -1e-4;
  write_file_atomically(argv[1], to_html(page));
}
