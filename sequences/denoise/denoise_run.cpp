#include "sequences/denoise/denoise_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "sequences/denoise/bounded_queue.h"
#include "sequences/denoise/ready_frame.h"
#include "sequences/exr/exr_complete.h"
#include "sequences/exr/exr_rewrite.h"
#include "sequences/files/checkpoint.h"
#include "sequences/files/directory.h"
#include "temporal/eigen/soft_denoiser.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Frames that wait between reading, computing and writing. One is enough to overlap them.
constexpr std::size_t kWaiting = 1;

// A frame to be written.
struct FinishedFrame {
  std::shared_ptr<const RawFrame> raw;
  std::vector<std::vector<NewChannel>> outputs;  // for each input
  std::size_t index = 0;
  bool is_written = true;  // its outputs are not there yet
  DenoiseRecord record;
  std::vector<char> state;  // of the denoisers behind this frame; empty: no checkpoint is due
};

// What makes two runs the same run.
std::string describe(const DenoiseSettings& settings, const DenoisePlan& plan) {
  nlohmann::ordered_json json;
  json["inputs"] = settings.files.inputs;
  json["map"] = settings.layers.map;
  json["keep"] = settings.layers.keep;
  json["skip"] = settings.layers.skip;
  json["alpha"] = settings.layers.denoises_alpha;
  json["motion"] = settings.guides.motion;
  json["camera"] = settings.guides.camera;
  json["cuts"] = plan.cuts;
  json["canvas"] = {plan.canvas.x, plan.canvas.y, plan.canvas.width, plan.canvas.height};
  for (const FrameFiles& frame : plan.frames) json["frames"].push_back(frame.frame);
  return json.dump();
}

fs::path checkpoint_path(const DenoisePlan& plan) {
  // Other shots, and other parts of this one, may go to the same folder at the same time.
  const fs::path& first = plan.frames.front().outputs.front();
  return first.parent_path() / fmt::format(".{}.eigenlight-state", first.filename().string());
}

class Run {
 public:
  Run(const DenoiseSettings& settings, const DenoisePlan& plan, const DenoiseCallbacks& callbacks)
      : settings_(settings), plan_(plan), callbacks_(callbacks), ready_(kWaiting), done_(kWaiting) {
    description_ = describe(settings, plan);
    for (std::size_t v = 0; v < plan.layers.views.size(); ++v) {
      const ViewPlan& view = plan.layers.views[v];
      builders_.emplace_back(view, plan.readings[v], plan.canvas, plan.cuts);
      denoisers_.push_back(std::make_unique<SoftDenoiser>(
          DenoiserOptions{.extent = {plan.canvas.width, plan.canvas.height},
                          .layers = static_cast<int>(view.lights.size())}));
    }
  }

  DenoiseTotals run();

 private:
  void read_frames();
  void write_frames();
  void denoise_frames();
  FinishedFrame denoise(ReadyFrame ready, std::size_t index);
  void write_frame(const FinishedFrame& frame, DenoiseRecord& record);
  void load();
  [[nodiscard]] std::vector<char> state() const;
  [[nodiscard]] bool is_complete(std::size_t index) const;
  void add_notes(const std::vector<std::string>& lines);
  void finish();

  const DenoiseSettings& settings_;
  const DenoisePlan& plan_;
  const DenoiseCallbacks& callbacks_;
  std::vector<FrameBuilder> builders_;
  std::vector<std::unique_ptr<SoftDenoiser>> denoisers_;
  BoundedQueue<ReadyFrame> ready_;
  BoundedQueue<FinishedFrame> done_;
  std::size_t position_ = 0;  // frames that were complete before
  std::string description_;
  DenoiseTotals totals_;  // the writer's while it runs
};

void Run::read_frames() {
  try {
    // The frame before is read again for what motion and depth say of it.
    const std::size_t start = position_ > 0 ? position_ - 1 : 0;
    for (std::size_t i = start; i < plan_.frames.size(); ++i) {
      StageClock clock;
      ReadyFrame ready;
      ready.raw = std::make_shared<const RawFrame>(
          read_raw_frame(plan_.frames[i], plan_.layers, plan_.canvas));
      for (FrameBuilder& builder : builders_) {
        ready.views.push_back(std::make_unique<Frame>());
        builder.build(ready.raw, *ready.views.back());
      }
      ready.read_ms = clock.lap().wall_ms;
      if (i >= position_ && !ready_.push(std::move(ready))) return;
    }
    ready_.close();
  } catch (...) {
    ready_.close(std::current_exception());
  }
}

void Run::add_notes(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (std::find(totals_.notes.begin(), totals_.notes.end(), line) == totals_.notes.end()) {
      totals_.notes.push_back(line);
    }
  }
}

void Run::write_frame(const FinishedFrame& frame, DenoiseRecord& record) {
  StageClock clock;
  const FrameFiles& paths = plan_.frames[frame.index];
  for (std::size_t i = 0; i < paths.outputs.size(); ++i) {
    std::vector<ExrReplacement> replacements;
    for (const NewChannel& channel : frame.outputs[i]) {
      replacements.push_back({channel.channel, &channel.values});
    }
    const fs::path folder = paths.outputs[i].parent_path();
    if (!folder.empty()) make_directory(folder);
    const ExrRewriteReport report =
        rewrite_exr(*frame.raw->files[i], paths.outputs[i], replacements);
    totals_.clamped += report.values.clamped;
    record.clamped += report.values.clamped;
    add_notes(report.recompressed);
    add_notes(report.levels);
  }
  ++totals_.frames;
  record.write_ms = clock.lap().wall_ms;
}

void Run::write_frames() {
  try {
    while (const std::optional<FinishedFrame> frame = done_.pop()) {
      DenoiseRecord record = frame->record;
      if (frame->is_written) {
        write_frame(*frame, record);
      } else {
        ++totals_.skipped;
      }
      if (callbacks_.record) callbacks_.record(record);
      if (!frame->state.empty()) {
        write_checkpoint(checkpoint_path(plan_), {description_, frame->index + 1, frame->state});
      }
      callbacks_.frame_done(plan_.frames[frame->index].frame);
    }
  } catch (...) {
    done_.close(std::current_exception());
  }
}

std::vector<char> Run::state() const {
  StateWriter writer;
  for (const auto& denoiser : denoisers_) denoiser->save(writer);
  return writer.bytes();
}

void Run::load() {
  const fs::path path = checkpoint_path(plan_);
  if (!settings_.resume || !fs::exists(path)) return;
  const Checkpoint checkpoint = read_checkpoint(path);
  if (checkpoint.run != description_) {
    throw CheckpointError(
        fmt::format("{}: of a run with other inputs or options; remove it, or go on with those",
                    path.string()));
  }
  for (std::size_t i = 0; i < checkpoint.position; ++i) {
    check_complete(path, plan_.frames[i].frame, plan_.frames[i].outputs);
  }
  restore_state(path, checkpoint, [&](StateReader& reader) {
    for (const auto& denoiser : denoisers_) denoiser->load(reader);
  });
  position_ = checkpoint.position;
}

bool Run::is_complete(std::size_t index) const {
  const std::vector<fs::path>& outputs = plan_.frames[index].outputs;
  return std::all_of(outputs.begin(), outputs.end(), is_complete_exr);
}

FinishedFrame Run::denoise(ReadyFrame ready, std::size_t index) {
  FinishedFrame finished;
  finished.raw = ready.raw;
  finished.index = index;
  finished.record.read_ms = ready.read_ms;
  finished.outputs.resize(plan_.frames[index].inputs.size());
  for (std::size_t v = 0; v < denoisers_.size(); ++v) {
    ReadySource source;
    source.set(ready.views[v].get());
    SoftDenoiser& denoiser = *denoisers_[v];
    if (!denoiser.step(source)) throw std::logic_error("a frame was lost");
    add_report(denoiser.report(), finished.record);
    StageClock clock;
    std::vector<const Planes<3>*> lights;
    for (int i = 0; i < denoiser.layers(); ++i) lights.push_back(&denoiser.output(i));
    compose_view(*ready.raw, plan_.layers.views[v], plan_.canvas, lights, finished.outputs);
    finished.record.compose_ms += clock.lap().wall_ms;
  }
  return finished;
}

void Run::denoise_frames() {
  const std::chrono::duration<double> interval(settings_.checkpoint_seconds);
  auto saved = Clock::now();
  bool stops = false;
  for (std::size_t i = position_; i < plan_.frames.size() && !stops; ++i) {
    std::optional<ReadyFrame> ready = ready_.pop();
    if (!ready) break;
    FinishedFrame finished = denoise(std::move(*ready), i);
    finished.is_written = !settings_.skip_existing || !is_complete(i);
    stops = callbacks_.interrupted();
    const bool is_last = i + 1 == plan_.frames.size();
    if (!is_last && (stops || Clock::now() - saved >= interval)) {
      finished.state = state();
      saved = Clock::now();
    }
    if (!done_.push(std::move(finished))) break;
  }
}

void Run::finish() {
  for (std::size_t v = 0; v < builders_.size(); ++v) {
    const ViewPlan& view = plan_.layers.views[v];
    for (std::size_t i = 0; i < view.lights.size(); ++i) {
      const std::int64_t count = builders_[v].not_finite()[i];
      if (count > 0) totals_.not_finite[view.lights[i].what] += count;
    }
  }
  if (position_ + totals_.frames + totals_.skipped < plan_.frames.size()) return;
  std::error_code error;
  fs::remove(checkpoint_path(plan_), error);
}

DenoiseTotals Run::run() {
  const auto start = Clock::now();
  load();
  std::thread reader([this] { read_frames(); });
  std::thread writer([this] { write_frames(); });
  std::exception_ptr error;
  try {
    denoise_frames();
  } catch (...) {
    error = std::current_exception();
  }
  ready_.close();
  done_.close();
  reader.join();
  writer.join();
  if (error) std::rethrow_exception(error);
  (void)done_.pop();  // rethrows what stopped the writer
  finish();
  totals_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return totals_;
}

}  // namespace

DenoiseTotals run_denoising(const DenoiseSettings& settings, const DenoisePlan& plan,
                            const DenoiseCallbacks& callbacks) {
  return Run(settings, plan, callbacks).run();
}

}  // namespace eigenlight
