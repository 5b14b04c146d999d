#include "sequences/compare/antialias_run.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "sequences/compare/output_metrics.h"
#include "sequences/files/compose.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/runs/render_plan.h"
#include "temporal/methods.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// A frame of one source, with what its picture is made from.
struct Shot {
  LiveSource& source;
  const Frame& frame;
  const Planes<3>& indirect;
};

PictureStats make_picture(const AntialiasOptions& options, const Shot& shot, Planes<3>& out) {
  if (options.mode != AntialiasMode::kNone) {
    return shot.source.picture(options, shot.frame, shot.indirect, out);
  }
  compose(shot.frame, shot.indirect, out);
  return {};
}

Planes<3> mean_of(const Planes<3>& a, const Planes<3>& b) {
  Planes<3> mean = make_planes<3>(a[0].extent());
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < mean[c].height(); ++y) {
      for (int x = 0; x < mean[c].width(); ++x) mean[c](x, y) = 0.5f * (a[c](x, y) + b[c](x, y));
    }
  }
  return mean;
}

// One way of antialiasing.
class Entry {
 public:
  Entry(const CompareGroup& group, const Contender& contender)
      : options_(*contender.antialias), metrics_(metric_options(group)) {
    cell_.contender = contender.label;
    cell_.spp = group.spp;
    cell_.antialias.emplace();
    if (group.pictures.empty()) return;
    pictures_ = group.pictures / contender.label;
    fs::create_directories(pictures_);
  }

  // Of a denoised frame; `reference_ms` is what kAntialiasReference takes for it.
  void add_cost(const Shot& shot, const FrameReport& report, double reference_ms) {
    Planes<3> picture;
    StageClock clock;
    const PictureStats stats = make_picture(options_, shot, picture);
    const bool is_none = options_.mode == AntialiasMode::kNone;
    cell_.antialias->ms += is_none ? 0.0 : clock.lap().cpu_ms;
    cell_.antialias->reference_ms += reference_ms;
    cell_.antialias->unmatched +=
        static_cast<double>(stats.unmatched) /
        static_cast<double>(std::max<std::int64_t>(4 * report.surface_pixels, 1));
    cell_.render_ms += report[Stage::kSource].cpu_ms + report[Stage::kResample].cpu_ms;
    cell_.denoise_ms += denoise_cpu_ms(report);
    cell_.extra_spp += extra_samples_per_pixel(report);
  }
  void measure(const ReferenceFrame& references, const std::array<Shot, 2>& shots) {
    std::array<Planes<3>, 2> pictures;
    for (std::size_t i = 0; i < 2; ++i) (void)make_picture(options_, shots[i], pictures[i]);
    if (!pictures_.empty()) {
      write_float_layer(pictures_ / FilePattern(kFramePattern).name(references.frame), "RGB",
                        mean_of(pictures[0], pictures[1]));
    }
    metrics_.add(references, std::move(pictures[0]), std::move(pictures[1]));
  }
  [[nodiscard]] Cell finish() && {
    const auto count = static_cast<double>(metrics_.frames().size());
    for (double* sum : {&cell_.render_ms, &cell_.denoise_ms, &cell_.extra_spp, &cell_.antialias->ms,
                        &cell_.antialias->reference_ms, &cell_.antialias->unmatched}) {
      *sum /= count;
    }
    cell_.frames = metrics_.frames();
    cell_.bad_pixels = metrics_.bad_pixels();
    return std::move(cell_);
  }

 private:
  AntialiasOptions options_;
  OutputMetrics metrics_;
  fs::path pictures_;
  Cell cell_;
};

class AntialiasRun {
 public:
  AntialiasRun(const ComparePlan& plan, const CompareGroup& group) : plan_(plan), group_(group) {
    for (const Contender* contender : group.contenders) entries_.emplace_back(group, *contender);
  }

  [[nodiscard]] bool run(const RunControl& control) {
    RenderOptions usual;
    LiveSource denoised = open_source(usual, plan_.frames, plan_.seed);
    const auto denoiser = make_denoiser(kDefaultMethod, {plan_.extent, plan_.bases});
    RenderOptions clean;
    clean.spp = group_.spp;
    clean.direct_spp = kReferenceDirectSpp;
    LiveSource first = open_source(clean, plan_.measured, 2 * plan_.seed);
    LiveSource second = open_source(clean, plan_.measured, 2 * plan_.seed + 1);
    for (const int frame : plan_.frames) {
      const Planes<3>* indirect = denoiser->step(denoised);
      if (frame >= plan_.measured.front()) {
        add_costs({denoised, denoiser->frame(), *indirect}, denoiser->report());
        measure(frame, first, second);
      }
      control.frame_done(frame);
      if (control.stops()) return false;
    }
    return true;
  }
  [[nodiscard]] std::vector<Cell> finish() && {
    std::vector<Cell> cells;
    for (Entry& entry : entries_) cells.push_back(std::move(entry).finish());
    return cells;
  }

 private:
  [[nodiscard]] LiveSource open_source(RenderOptions options, const std::vector<int>& frames,
                                       std::uint32_t seed) const {
    options.extent = plan_.extent;
    options.bounces = plan_.bounces;
    options.seed = seed;
    return {group_.animated.scene, group_.animated.animation, options, frames};
  }
  void add_costs(const Shot& shot, const FrameReport& report) {
    Planes<3> supersampled;
    StageClock clock;
    (void)make_picture(kAntialiasReference, shot, supersampled);
    const double reference_ms = clock.lap().cpu_ms;
    for (Entry& entry : entries_) entry.add_cost(shot, report, reference_ms);
  }
  void measure(int frame, LiveSource& first, LiveSource& second) {
    std::array<Frame, 2> frames;
    (void)first.next(frames[0]);
    (void)second.next(frames[1]);
    ReferenceFrame references{frame, group_.references.load(ReferenceCache::Half::kA, frame),
                              group_.references.load(ReferenceCache::Half::kB, frame),
                              Plane<std::uint8_t>(plan_.extent)};
    references.bits.fill(kSurfaceBit);
    const std::array<Shot, 2> shots{Shot{first, frames[0], frames[0].lights[0].radiance},
                                    Shot{second, frames[1], frames[1].lights[0].radiance}};
    for (Entry& entry : entries_) entry.measure(references, shots);
  }

  const ComparePlan& plan_;
  const CompareGroup& group_;
  std::vector<Entry> entries_;
};

}  // namespace

std::optional<std::vector<Cell>> run_antialias_group(const ComparePlan& plan,
                                                     const CompareGroup& group,
                                                     const RunControl& control) {
  AntialiasRun run(plan, group);
  if (!run.run(control)) return std::nullopt;
  return std::move(run).finish();
}

}  // namespace eigenlight
