#include "sequences/lab/paper_xu2024.h"

#include "sequences/lab/paper_reruns.h"

namespace eigenlight {
namespace {

PaperReport rerun_xu2024(const PaperRun& run) {
  PaperReport report;
  xu_quality(run, report);
  xu_inputs(run, report);
  xu_parts(run, report);
  xu_times(run, report);
  return report;
}

}  // namespace

Paper xu2024() {
  return {"xu2024",
          "Xu, Yang, Qin, Sheng and Wu 2024, Fast Approximation to Large-Kernel Edge-Preserving "
          "Filters by Recursive Reconstruction from Image Pyramids",
          "AMD Ryzen 7 5700X and Radeon RX 6800, 2560x1440, GPU time", rerun_xu2024, "384x216"};
}

}  // namespace eigenlight
