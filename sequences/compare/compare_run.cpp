#include "sequences/compare/compare_run.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "sequences/compare/external_entry.h"
#include "sequences/compare/output_metrics.h"
#include "sequences/compare/shared_source.h"
#include "sequences/files/compose.h"
#include "sequences/runs/frame_writer.h"
#include "temporal/eigen/direct_denoiser.h"
#include "temporal/methods.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// Bytes in use on the heap, large blocks with mappings of their own included.
double heap_bytes() {
  const struct mallinfo2 info = ::mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

// One of our own methods.
class LiveEntry {
 public:
  LiveEntry(const ComparePlan& plan, const CompareGroup& group, const Contender& contender)
      : method_(contender.method),
        options_{.extent = plan.extent, .bases = plan.bases},
        metrics_(metric_options(group)) {
    cell_.contender = contender.label;
    cell_.spp = group.spp;
    if (!contender.without.empty()) options_.without = {contender.without};
    is_whole_ = plan.is_whole;
    restart();
    if (group.pictures.empty()) return;
    const std::vector<Layer> shown{is_whole_ ? Layer::kColor : Layer::kIndirect};
    const fs::path folder = group.pictures / contender.label;
    fs::create_directories(folder);
    writer_.emplace(folder, shown, std::vector<ExrAttribute>{});
  }

  // A method that reads ahead leaves the shared frames with its first step.
  void take_frame(SharedSource& source) {
    if (reads_ahead_) return;
    SingleFrameSource once(source);
    step(once);
    reads_ahead_ = once.was_read_ahead();
    if (direct_) denoise_direct(source.live());
  }
  void step(FrameSource& source) {
    const double before = heap_bytes();
    output_ = denoiser_->step(source);
    note_growth(before);
  }
  [[nodiscard]] bool reads_ahead() const { return reads_ahead_; }
  void restart() {
    denoiser_.reset();
    held_ = peak_ = 0.0;
    const double before = heap_bytes();
    denoiser_ = make_denoiser(method_, options_);
    if (is_whole_ && method_ != "noisy") {
      direct_ = std::make_unique<DirectDenoiser>(
          DenoiserOptions{.extent = options_.extent, .bases = options_.bases});
    }
    note_growth(before);
  }
  // Of the frame of the last step.
  void measure(const ReferenceFrame& references, const StageTime& rendering) {
    const Frame& frame = denoiser_->frame();
    const FrameReport& report = denoiser_->report();
    cell_.render_ms += rendering.cpu_ms + report[Stage::kResample].cpu_ms;
    cell_.denoise_ms += denoise_cpu_ms(report) + direct_ms_;
    cell_.extra_spp += extra_samples_per_pixel(report);
    const Planes<3>& direct = direct_ ? direct_->output() : frame.direct;
    if (writer_) writer_->write({frame, *output_, denoiser_->age(), nullptr, &direct});
    Planes<3> light;
    if (is_whole_) {
      compose(frame, *output_, direct, light);
    } else {
      modulate(frame.surface.albedo, *output_, light);
    }
    metrics_.add(references, std::move(light));
  }
  [[nodiscard]] Cell finish() && {
    const auto count = static_cast<double>(metrics_.frames().size());
    cell_.render_ms /= count;
    cell_.denoise_ms /= count;
    cell_.extra_spp /= count;
    cell_.memory_mb = peak_ * 1e-6;
    cell_.frames = metrics_.frames();
    cell_.bad_pixels = metrics_.bad_pixels();
    return std::move(cell_);
  }

 private:
  void denoise_direct(const LiveSource& source) {
    const double before = heap_bytes();
    StageClock clock;
    direct_->step(denoiser_->frame(), source.sun(), source.soft());
    direct_ms_ = clock.lap().cpu_ms;
    note_growth(before);
  }
  // Others allocate in between, so growth is added up over this method's own steps.
  void note_growth(double before) {
    held_ += heap_bytes() - before;
    peak_ = std::max(peak_, held_);
  }

  std::string method_;
  DenoiserOptions options_;
  std::unique_ptr<Denoiser> denoiser_;
  bool is_whole_ = false;
  std::unique_ptr<DirectDenoiser> direct_;  // of whole pictures
  double direct_ms_ = 0.0;                  // what its last step took
  const Planes<3>* output_ = nullptr;
  bool reads_ahead_ = false;
  OutputMetrics metrics_;
  std::optional<FrameWriter> writer_;
  Cell cell_;
  double held_ = 0.0, peak_ = 0.0;
};

// Removes the scratch directory however the run ends.
class Scratch {
 public:
  explicit Scratch(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  ~Scratch() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

 private:
  fs::path path_;
};

class GroupRun {
 public:
  GroupRun(const ComparePlan& plan, const CompareGroup& group)
      : plan_(plan),
        group_(group),
        scratch_(group.scratch),
        ages_(make_denoiser("mean", {plan.extent, plan.bases})) {
    for (const Contender* contender : group.contenders) {
      if (contender->external) {
        external_.push_back(std::make_unique<ExternalEntry>(plan, group, *contender));
      } else {
        live_.push_back(std::make_unique<LiveEntry>(plan, group, *contender));
      }
    }
  }

  [[nodiscard]] bool run(const RunControl& control) {
    LiveSource live = open_source();
    SharedSource source(live);
    while (source.render()) {
      take(source);
      control.frame_done(source.frame().index);
      if (control.stops()) return false;
    }
    for (const auto& entry : live_) {
      if (entry->reads_ahead() && !run_alone(*entry, control)) return false;
    }
    for (const auto& entry : external_) {
      if (!entry->run(control.stops)) return false;
      for (std::size_t i = 0; i < plan_.measured.size(); ++i) entry->measure(references_of(i));
    }
    return true;
  }
  // In the order of the contenders.
  [[nodiscard]] std::vector<Cell> finish() && {
    std::vector<Cell> cells;
    auto live = live_.begin();
    auto external = external_.begin();
    const double render_ms = render_ms_ / static_cast<double>(plan_.measured.size());
    for (const Contender* contender : group_.contenders) {
      cells.push_back(contender->external ? std::move(**external++).finish(render_ms)
                                          : std::move(**live++).finish());
    }
    return cells;
  }

 private:
  [[nodiscard]] LiveSource open_source() const {
    RenderOptions options;
    options.extent = plan_.extent;
    options.spp = group_.spp;
    options.bounces = plan_.bounces;
    options.seed = plan_.seed;
    return {group_.animated.scene, group_.animated.animation, options, plan_.frames};
  }
  // The same bits from a source of its own; time of rendering is that of the shared frames.
  [[nodiscard]] bool run_alone(LiveEntry& entry, const RunControl& control) const {
    LiveSource source = open_source();
    entry.restart();
    const std::size_t warmup = plan_.frames.size() - plan_.measured.size();
    for (std::size_t i = 0; i < plan_.frames.size(); ++i) {
      entry.step(source);
      if (control.stops()) return false;
      if (i >= warmup) entry.measure(references_of(i - warmup), render_times_[i - warmup]);
    }
    return true;
  }
  void take(SharedSource& source) {
    (void)ages_->step(source);
    for (const auto& entry : live_) entry->take_frame(source);
    for (const auto& entry : external_) entry->add(source.frame());
    const int frame = source.frame().index;
    if (frame < plan_.measured.front()) return;
    render_ms_ += source.render_time().cpu_ms;
    render_times_.push_back(source.render_time());
    bits_.push_back(surface_bits(source.frame().surface.id, ages_->age()));
    const ReferenceFrame references = references_of(bits_.size() - 1);
    for (const auto& entry : live_) {
      if (!entry->reads_ahead()) entry->measure(references, source.render_time());
    }
  }
  [[nodiscard]] ReferenceFrame references_of(std::size_t i) const {
    const int frame = plan_.measured[i];
    return {frame, group_.references.load(ReferenceCache::Half::kA, frame),
            group_.references.load(ReferenceCache::Half::kB, frame), bits_[i].clone()};
  }

  const ComparePlan& plan_;
  const CompareGroup& group_;
  Scratch scratch_;
  std::unique_ptr<Denoiser> ages_;
  std::vector<std::unique_ptr<LiveEntry>> live_;
  std::vector<std::unique_ptr<ExternalEntry>> external_;
  std::vector<Plane<std::uint8_t>> bits_;  // of each measured frame
  std::vector<StageTime> render_times_;    // and what they took to render
  double render_ms_ = 0.0;
};

}  // namespace

MetricOptions metric_options(const CompareGroup& group) {
  MetricOptions options;
  options.exposure = group.exposure;
  return options;
}

double denoise_cpu_ms(const FrameReport& report) {
  double ms = 0.0;
  for (std::size_t s = 0; s < report.time.size(); ++s) {
    const auto stage = static_cast<Stage>(s);
    if (stage != Stage::kSource && stage != Stage::kResample) ms += report[stage].cpu_ms;
  }
  return ms;
}

double extra_samples_per_pixel(const FrameReport& report) {
  return static_cast<double>(report.extra_samples) /
         static_cast<double>(std::max<std::int64_t>(report.surface_pixels, 1));
}

std::optional<std::vector<Cell>> run_group(const ComparePlan& plan, const CompareGroup& group,
                                           const RunControl& control) {
  GroupRun run(plan, group);
  if (!run.run(control)) return std::nullopt;
  return std::move(run).finish();
}

}  // namespace eigenlight
