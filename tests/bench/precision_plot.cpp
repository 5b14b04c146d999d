// precision_plot FRAMES WIDTH OUT.svg: runs `eigenlight` in float beside its twin in double on the
// built-in scenes, prints the largest relative difference of each, and draws it over the frames.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "sequences/files/atomic_file.h"
#include "tests/support/precision_run.h"

namespace eigenlight {
namespace {

struct Curve {
  std::string name;
  const char* color;
  std::vector<double> values;
};

constexpr double kWidth = 720.0, kHeight = 300.0, kLeft = 60.0, kTop = 20.0, kBottom = 40.0;
// Decades drawn: 1e-8 to 1e-2.
constexpr double kLowest = -8.0, kHighest = -2.0;

double ordinate(double value) {
  const double log = std::clamp(std::log10(std::max(value, 1e-30)), kLowest, kHighest);
  return kTop + (kHeight - kTop - kBottom) * (kHighest - log) / (kHighest - kLowest);
}

std::string polyline(const Curve& curve) {
  std::string points;
  const double step = (kWidth - kLeft - 20.0) / static_cast<double>(curve.values.size());
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    points += fmt::format("{:.1f},{:.1f} ", kLeft + step * static_cast<double>(i),
                          ordinate(curve.values[i]));
  }
  return fmt::format(R"(<polyline fill="none" stroke="{}" points="{}"/>)", curve.color, points);
}

std::string drawing(const std::vector<Curve>& curves) {
  std::string svg = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" )"
      R"(font-family="sans-serif" font-size="12"><rect width="{0}" height="{1}" fill="white"/>)",
      kWidth, kHeight);
  for (double decade = kLowest; decade <= kHighest; decade += 1.0) {
    const double y = ordinate(std::pow(10.0, decade));
    svg += fmt::format(
        R"(<path d="M{} {:.1f}H{}" stroke="{}"/><text x="8" y="{:.1f}">1e{:.0f}</text>)", kLeft, y,
        kWidth - 20.0, decade == -3.0 ? "red" : "#ddd", y + 4.0, decade);
  }
  double x = kLeft;
  for (const Curve& curve : curves) {
    svg += polyline(curve);
    svg += fmt::format(R"(<text x="{}" y="{}" fill="{}">{}</text>)", x, kHeight - 8.0, curve.color,
                       curve.name);
    x += 120.0;
  }
  return svg +
         fmt::format(R"(<text x="{}" y="{}">frames 0 to {}</text></svg>)", x, kHeight - 8.0,
                     curves[0].values.size() - 1) +
         "\n";
}

Curve run(const PrecisionScene& scene, const char* color) {
  Curve curve{scene.name, color, {}};
  if (scene.perturbation.kind == Perturbation::kLights) curve.name += ", lights";
  PrecisionRun beside(scene);
  for (double off = beside.step(); off >= 0.0; off = beside.step()) curve.values.push_back(off);
  fmt::print("{:<16}{:>6} frames, largest {:.2e}, births of bases {}\n", curve.name,
             curve.values.size(), *std::max_element(curve.values.begin(), curve.values.end()),
             beside.births());
  std::fflush(stdout);
  return curve;
}

int plot(int frames, int width, const char* path) {
  const Extent extent{width, width * 9 / 16};
  std::vector<Curve> curves;
  curves.push_back(run({"cornell", Perturbation::kNone, extent, frames}, "#1f77b4"));
  curves.push_back(run({"atrium", Perturbation::kNone, extent, frames}, "#2ca02c"));
  curves.push_back(run({"gallery", Perturbation::kNone, extent, frames}, "#9467bd"));
  curves.push_back(run({"atrium", Perturbation::kLights, extent, frames}, "#ff7f0e"));
  write_file_atomically(path, drawing(curves));
  return 0;
}

}  // namespace
}  // namespace eigenlight

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: precision_plot FRAMES WIDTH OUT.svg\n", stderr);
    return 2;
  }
  try {
    return eigenlight::plot(std::stoi(argv[1]), std::stoi(argv[2]), argv[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "precision_plot: %s\n", error.what());
    return 1;
  }
}
