// precision_curves FRAMES WIDTH OUT.json: runs `eigenlight` in float beside its twin in double on
// the built-in scenes, prints the largest relative difference of each, and writes it frame by
// frame. chart.py OUT.json OUT.svg draws it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sequences/files/atomic_file.h"
#include "tests/support/precision_run.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

// Frames and differences of one scene. The axis is logarithmic: equal pictures count as 1e-9.
Json curve(const PrecisionScene& scene) {
  PrecisionRun run(scene);
  Json points = Json::array();
  double largest = 0.0;
  for (double off = run.step(); !(off < 0.0); off = run.step()) {
    if (std::isnan(off)) {
      throw std::runtime_error(fmt::format("{}: NaN in frame {}", scene.name, points.size()));
    }
    points.push_back({points.size(), std::max(off, 1e-9)});
    largest = std::max(largest, off);
  }
  const char* lights = scene.perturbation.kind == Perturbation::kLights ? ", lights" : "";
  fmt::print("{:<16}{:>6} frames, largest {:.2e}, births of bases {}\n", scene.name + lights,
             points.size(), largest, run.births());
  std::fflush(stdout);
  return points;
}

void write_curves(int frames, int width, const char* path) {
  const Extent extent{width, width * 9 / 16};
  Json series = Json::object();
  for (const char* scene : {"cornell", "atrium", "gallery"}) {
    series[scene] = curve({scene, Perturbation::kNone, extent, frames});
  }
  series["atrium, lights"] = curve({"atrium", Perturbation::kLights, extent, frames});
  series["bound of the tests"] = {{0, 1e-3}, {frames - 1, 1e-3}};
  const Json plot{{"title", "Float against double"},
                  {"x", "frame"},
                  {"y", "largest relative difference"},
                  {"log", {false, true}},
                  {"series", series}};
  write_file_atomically(path, plot.dump() + "\n");
}

}  // namespace
}  // namespace eigenlight

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: precision_curves FRAMES WIDTH OUT.json\n", stderr);
    return 2;
  }
  try {
    eigenlight::write_curves(std::stoi(argv[1]), std::stoi(argv[2]), argv[3]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "precision_curves: %s\n", error.what());
    return 1;
  }
}
