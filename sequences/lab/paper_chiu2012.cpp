// Chiu 2012: subpixel reconstruction against supersampling.
#include "sequences/lab/paper_chiu2012.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "sequences/lab/paper_reruns.h"
#include "sequences/lab/paper_scene.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

constexpr AntialiasOptions kTruth{AntialiasMode::kSupersample, 16};

// Table 1: ms of the two passes of their method.
struct PassRow {
  int side;
  double first, second;
};
constexpr std::array<PassRow, 2> kTable1{{{256, 18, 5}, {512, 35, 14}}};

struct Times {
  double frame = 0.0, sraa = 0.0, supersample = 0.0;
};

double picture_ms(LiveSource& source, const AntialiasOptions& options, const Frame& frame) {
  Planes<3> color;
  StageClock clock;
  source.picture(options, frame, frame.lights[0].radiance, color);
  return clock.lap().cpu_ms;
}

Times time_at(int side, int frame_number) {
  const PaperScene scene("atrium", Perturbation::kNone, {side, side});
  LiveSource source = scene.source({.spp = 1, .direct_spp = 1}, {frame_number, frame_number});
  Frame frame;
  // The first frame also builds the scene.
  if (!source.next(frame)) throw std::logic_error("no frame");
  StageClock clock;
  if (!source.next(frame)) throw std::logic_error("no frame");
  Times times;
  times.frame = clock.lap().cpu_ms;
  times.sraa = picture_ms(source, {AntialiasMode::kSraa}, frame);
  times.supersample = picture_ms(source, kTruth, frame);
  return times;
}

void claim_times(const std::array<Times, 2>& times, PaperReport& report) {
  const auto speedup = [](const Times& t) { return t.supersample / (t.frame + t.sraa); };
  const double least = std::min(speedup(times[0]), speedup(times[1]));
  report.claims.push_back(
      {"Fig. 3", "a frame with subpixel reconstruction is faster than one supersampled 16 times",
       "6 times as fast",
       fmt::format("{:.1f} (256x256), {:.1f} (512x512) times", speedup(times[0]),
                   speedup(times[1])),
       least >= 6.0   ? Verdict::kHeld
       : least >= 3.0 ? Verdict::kInPart
                      : Verdict::kNot});
  const double growth = times[1].sraa / times[0].sraa;
  report.claims.push_back(
      {"Table 1", "time grows no faster than pixels: 512x512 / 256x256 (4 x pixels)", "2.13",
       fmt::format("{:.2f}", growth), growth <= 4.4 ? Verdict::kHeld : Verdict::kNot});
}

// The scenes and modes of Fig. 5.
constexpr std::array<const char*, 3> kScenes{"cornell", "gallery", "atrium"};
struct Way {
  const char* name;
  AntialiasMode mode;
};
constexpr std::array<Way, 4> kWays{{{"none", AntialiasMode::kNone},
                                    {"lookup", AntialiasMode::kLookup},
                                    {"sraa-geometry", AntialiasMode::kSraaGeometry},
                                    {"sraa", AntialiasMode::kSraa}}};
constexpr int kTruthSpp = 8, kTruthDirectSpp = 16;  // at each of 16 points of a pixel
constexpr int kSpp = 24, kDirectSpp = 64;

Planes<3> guide_colors(const Frame& frame) {
  Planes<3> color = make_planes<3>(frame.extent());
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame.extent().height; ++y) {
      for (int x = 0; x < frame.extent().width; ++x) {
        color[c](x, y) = frame.surface.albedo[c](x, y) *
                             (frame.direct[c](x, y) + frame.lights[0].radiance[c](x, y)) +
                         frame.emission[c](x, y);
      }
    }
  }
  return color;
}

std::vector<Planes<3>> pictures(const PaperScene& scene, const RenderOptions& options, int number,
                                const std::vector<AntialiasOptions>& ways) {
  LiveSource source = scene.source(options, {number});
  Frame frame;
  if (!source.next(frame)) throw std::logic_error("no frame");
  std::vector<Planes<3>> all;
  for (const AntialiasOptions& way : ways) {
    Planes<3> color;
    if (way.mode == AntialiasMode::kNone) {
      color = guide_colors(frame);
    } else {
      source.picture(way, frame, frame.lights[0].radiance, color);
    }
    all.push_back(std::move(color));
  }
  return all;
}

// Mean of (x1 - A)(x2 - B) / (r^2 + 0.01), r = (A + B) / 2: all four are independent, so that noise
// cancels and aliasing stays. Pixels with a non-finite value in any of them are left out.
double error(const std::array<Planes<3>, 2>& x, const std::array<Planes<3>, 2>& truth) {
  double sum = 0.0, count = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < x[0][c].height(); ++y) {
      for (int i = 0; i < x[0][c].width(); ++i) {
        const auto at = [&](const Planes<3>& p) { return static_cast<double>(p[c](i, y)); };
        const double a = at(truth[0]), b = at(truth[1]), r = 0.5 * (a + b);
        const double value = (at(x[0]) - a) * (at(x[1]) - b) / (r * r + 0.01);
        if (!std::isfinite(value)) continue;
        sum += value;
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

using Errors = std::array<double, kWays.size()>;

Errors scene_errors(const PaperRun& run, const char* name) {
  const PaperScene scene(name, Perturbation::kNone, run.extent, PaperScene::View::kFlight);
  const int number = run.frames.back();
  std::array<Planes<3>, 2> truth;
  std::array<std::vector<Planes<3>>, 2> made;
  std::vector<AntialiasOptions> ways;
  for (const Way& way : kWays) ways.push_back({way.mode});
  for (std::uint32_t half = 0; half < 2; ++half) {
    run.step(fmt::format("Fig. 5, {}, {}", name, half + 1));
    const std::uint32_t seed = half == 0 ? kPaperReferenceA : kPaperReferenceB;
    truth[half] =
        std::move(pictures(scene, {.spp = kTruthSpp, .direct_spp = kTruthDirectSpp, .seed = seed},
                           number, {kTruth})
                      .front());
    made[half] =
        pictures(scene, {.spp = kSpp, .direct_spp = kDirectSpp, .seed = half + 1}, number, ways);
  }
  Errors errors{};
  for (std::size_t w = 0; w < kWays.size(); ++w) {
    errors[w] = error({std::move(made[0][w]), std::move(made[1][w])}, truth);
  }
  return errors;
}

Verdict verdict(std::size_t scenes) {
  if (scenes == kScenes.size()) return Verdict::kHeld;
  return scenes > 0 ? Verdict::kInPart : Verdict::kNot;
}

// Claims that `way` has a smaller error than `other`; texts are ratios of errors in each scene.
void claim_less(const std::array<Errors, 3>& errors, std::size_t way, std::size_t other,
                const std::string& claim, PaperReport& report) {
  std::vector<std::string> texts;
  std::size_t less = 0;
  for (std::size_t s = 0; s < kScenes.size(); ++s) {
    texts.push_back(fmt::format("{} {:.2f}", kScenes[s], errors[s][way] / errors[s][other]));
    if (errors[s][way] < errors[s][other]) ++less;
  }
  report.claims.push_back(
      {"Fig. 5", claim, "pictures only", fmt::format("{}", fmt::join(texts, ", ")), verdict(less)});
}

PaperReport rerun(const PaperRun& run) {
  PaperReport report;
  chiu_times(run, report);
  chiu_errors(run, report);
  return report;
}

}  // namespace

void chiu_times(const PaperRun& run, PaperReport& report) {
  PageTable table{"ms per frame by resolution",
                  "The paper: Sponza, both passes on a GPU except for rays. Here: CPU time of all "
                  "threads, atrium, 1 sample; reconstruction traces and shades in one pass.",
                  "resolution",
                  {{"first pass, paper"},
                   {"second pass, paper"},
                   {"reconstruction"},
                   {"frame before it"},
                   {"supersampling, 16 times"}},
                  {}};
  std::array<Times, kTable1.size()> times;
  for (std::size_t i = 0; i < kTable1.size(); ++i) {
    const PassRow& row = kTable1[i];
    run.step(fmt::format("Table 1, {0}x{0}", row.side));
    times[i] = time_at(row.side, run.frames.front());
    table.rows.push_back(
        {fmt::format("{0}x{0}", row.side),
         {row.first, row.second, times[i].sraa, times[i].frame, times[i].supersample}});
  }
  claim_times(times, report);
  report.sections.push_back({"Table 1 and Fig. 3: time", "", {}, {std::move(table)}, {}});
}

void chiu_errors(const PaperRun& run, PaperReport& report) {
  PageTable table{
      "Error against supersampling, 16 times",
      fmt::format("relMSE of the picture, {}x{}; the noise of independent pairs cancels",
                  run.extent.width, run.extent.height),
      "antialiasing",
      {},
      {}};
  for (const Way& way : kWays) table.rows.push_back({way.name, {}});
  std::array<Errors, kScenes.size()> errors;
  for (std::size_t s = 0; s < kScenes.size(); ++s) {
    errors[s] = scene_errors(run, kScenes[s]);
    table.columns.push_back({kScenes[s], TableColumn::Best::kLowest});
    for (std::size_t w = 0; w < kWays.size(); ++w) table.rows[w].cells.emplace_back(errors[s][w]);
  }
  claim_less(errors, 3, 0,
             "closer to supersampling than without antialiasing: error / error without", report);
  claim_less(errors, 3, 2,
             "better than SRAA of geometry alone, thanks to the shadow term: error / its error",
             report);
  report.sections.push_back({"Fig. 5: quality", "", {}, {std::move(table)}, {}});
}

Paper chiu2012() {
  return {"chiu2012",
          "Chiu, Chen, Chang and Lee 2012, Subpixel Reconstruction Antialiasing for Ray Tracing",
          "not named in the copy at hand, wall time", rerun};
}

}  // namespace eigenlight
