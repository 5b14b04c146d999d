// Fig. 5 of Chen 2012: frames until newly seen pixels have recovered.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sequences/lab/paper_chen2012.h"
#include "sequences/lab/paper_scene.h"
#include "sequences/stress/analytic_source.h"
#include "temporal/baselines/chen2012.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 36};
// The paper does not give the number of bases in the figure.
constexpr std::array<int, 3> kBases{1, 3, 5};
// The paper does not say how long the ball hides the wall. After 48 frames its weights are 3 / 48.
constexpr int kHidden = 48, kSeen = 72;
constexpr int kCardLeft = 24, kCardRight = 40;
constexpr std::uint32_t kSeeds = 16;
constexpr double kRecovered = 0.1;

// A card with its own light hides a part of the wall until frame kHidden.
AnalyticOptions card(std::uint32_t seed) {
  AnalyticOptions options{.extent = kExtent, .frames = kHidden + kSeen, .seed = seed};
  options.edit = [](Frame& frame) {
    frame.is_static = false;
    if (frame.index >= kHidden) return;
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = kCardLeft; x < kCardRight; ++x) {
        frame.surface.id(x, y) = 2;
        frame.surface.depth(x, y) = frame.previous_depth(x, y) = 0.5f * AnalyticSource::kDepth;
        for (auto& plane : frame.lights[0].radiance) plane(x, y) *= 0.3f;
      }
    }
  };
  return options;
}

using Sums = std::array<std::vector<Planes<3>>, 2>;  // for each half of the seeds, for each frame

// The expected picture of each frame: the mean over seeds, in which noise cancels and bias stays.
Sums mean_pictures(int bases, const ChenOptions& parts) {
  Sums sums;
  for (auto& half : sums) {
    for (int i = 0; i < kSeen; ++i) half.push_back(make_planes<3>(kExtent));
  }
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    AnalyticSource source(card(seed));
    Chen2012 method({kExtent, bases}, parts);
    // Without extra samples, which are another remedy (Fig. 6).
    std::vector<Frame> frames(kHidden + kSeen);
    for (Frame& frame : frames) {
      if (!source.next(frame)) throw std::logic_error("a source ends before its last frame");
    }
    MemorySource recorded(frames);
    for (int i = -kHidden; const Planes<3>* light = method.step(recorded); ++i) {
      if (i < 0) continue;
      Planes<3>& sum = sums[seed % 2][static_cast<std::size_t>(i)];
      for (std::size_t c = 0; c < 3; ++c) {
        auto to = sum[c].storage();
        const auto from = (*light)[c].storage();
        for (std::size_t p = 0; p < to.size(); ++p) to[p] += from[p] * (2.0f / kSeeds);
      }
    }
  }
  return sums;
}

// Root of the mean of bias^2 / truth^2 where the card was. The halves are independent, so that
// their noise cancels; a negative mean gives 0.
PlotSeries relative_bias(int bases, const ChenOptions& parts) {
  const Sums means = mean_pictures(bases, parts);
  const AnalyticSource truth(card(0));
  PlotSeries series{
      fmt::format("{} for {} bases", parts.per_pixel_weights ? "weights per pixel" : "one weight",
                  bases),
      {}};
  for (int i = 0; i < kSeen; ++i) {
    double sum = 0.0;
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = kCardLeft; x < kCardRight; ++x) {
        for (int c = 0; c < 3; ++c) {
          const auto channel = static_cast<std::size_t>(c), frame = static_cast<std::size_t>(i);
          const auto t = static_cast<double>(truth.truth({x, y}, c, kHidden + i));
          sum += (static_cast<double>(means[0][frame][channel](x, y)) / t - 1.0) *
                 (static_cast<double>(means[1][frame][channel](x, y)) / t - 1.0);
        }
      }
    }
    const double count = 3.0 * kExtent.height * (kCardRight - kCardLeft);
    series.points.push_back({static_cast<double>(i + 1), std::sqrt(std::max(sum / count, 0.0))});
  }
  return series;
}

// Frames until the bias stays below kRecovered; kSeen + 1 if it does not.
int frames_to_recover(const PlotSeries& series) {
  int frames = kSeen + 1;
  for (auto point = series.points.rbegin(); point != series.points.rend(); ++point) {
    if (point->y >= kRecovered) break;
    frames = static_cast<int>(point->x);
  }
  return frames;
}

std::string to_text(int frames) {
  return frames > kSeen ? fmt::format("more than {}", kSeen) : fmt::format("{}", frames);
}

}  // namespace

void chen_disocclusion(const PaperRun& run, PaperReport& report) {
  std::vector<PlotSeries> series;
  std::vector<std::string> counts;
  std::size_t held = 0, faster = 0;
  for (const int bases : kBases) {
    run.step(fmt::format("Fig. 5, disocclusion, {} bases", bases));
    series.push_back(relative_bias(bases, {.basis_filter = false}));
    series.push_back(relative_bias(bases, {.per_pixel_weights = false, .basis_filter = false}));
    const int fast = frames_to_recover(series.end()[-2]);
    const int slow = frames_to_recover(series.back());
    counts.push_back(fmt::format("{} against {} (K = {})", to_text(fast), to_text(slow), bases));
    if (slow > fast) ++faster;
    if (slow >= 10 * fast && fast <= 5) ++held;
  }
  report.claims.push_back(
      {"Fig. 5",
       fmt::format("frames until newly seen pixels have recovered (here: a bias below {:.0f} %), "
                   "with weights per pixel and with one weight",
                   100.0 * kRecovered),
       "5 against 50", fmt::format("{}", fmt::join(counts, ", ")),
       held == kBases.size() ? Verdict::kHeld
       : faster > 0          ? Verdict::kInPart
                             : Verdict::kNot});
  PagePlot plot{
      "Bias of newly seen pixels",
      fmt::format("A card that hides a wall of known light disappears after {} frames. Root of the "
                  "mean squared relative difference between the expected picture (mean over {} "
                  "seeds) and the truth; a black picture has 1. 3 samples per pixel, no extra "
                  "samples, no basis filter.",
                  kHidden, kSeeds),
      {"frames since the card disappeared"},
      {"relative bias", true},
      std::move(series)};
  report.sections.push_back({"Fig. 5: disocclusion", "", {std::move(plot)}, {}, {}});
}

}  // namespace eigenlight
