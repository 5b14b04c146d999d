#include "sequences/denoise/denoise_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "sequences/denoise/output_writer.h"
#include "sequences/denoise/ready_frame.h"
#include "sequences/exr/exr_complete.h"
#include "sequences/files/checkpoint.h"
#include "temporal/gather/window_denoiser.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

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
  json["lookahead"] = plan.lookahead;
  json["cuts"] = plan.cuts;
  json["canvas"] = {plan.canvas.x, plan.canvas.y, plan.canvas.width, plan.canvas.height};
  for (const FrameFiles& frame : plan.frames) json["frames"].push_back(frame.frame);
  return json.dump();
}

class Run {
 public:
  Run(const DenoiseSettings& settings, const DenoisePlan& plan, const DenoiseCallbacks& callbacks)
      : settings_(settings), plan_(plan), callbacks_(callbacks), ready_(kWaiting) {
    description_ = describe(settings, plan);
    WindowOptions options;
    options.ahead = plan.lookahead;
    for (std::size_t v = 0; v < plan.layers.views.size(); ++v) {
      const ViewPlan& view = plan.layers.views[v];
      builders_.emplace_back(view, plan.readings[v], plan.canvas, plan.cuts);
      denoisers_.push_back(
          std::make_unique<WindowDenoiser>(Extent{plan.canvas.width, plan.canvas.height},
                                           static_cast<int>(view.lights.size()), options));
    }
  }

  DenoiseTotals run();

 private:
  void load();
  void read_frames();
  [[nodiscard]] std::size_t first_read() const;
  void denoise_frames(OutputWriter& writer);
  [[nodiscard]] bool push_frame();
  [[nodiscard]] bool is_checkpoint_due();
  FinishedFrame denoise(std::size_t index);
  [[nodiscard]] bool is_complete(std::size_t index) const;
  void finish();

  const DenoiseSettings& settings_;
  const DenoisePlan& plan_;
  const DenoiseCallbacks& callbacks_;
  std::vector<FrameBuilder> builders_;
  std::vector<std::unique_ptr<WindowDenoiser>> denoisers_;
  BoundedQueue<ReadyFrame> ready_;
  std::deque<ReadyFrame> pushed_;  // frames that the denoisers hold and have not denoised
  std::size_t position_ = 0;       // frames that were complete before
  std::size_t next_push_ = 0;
  Clock::time_point saved_ = Clock::now();
  std::string description_;
  DenoiseTotals totals_;  // the writer's while it runs
};

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
  position_ = checkpoint.position;
}

// Frames before the first one to be denoised are read again: the denoisers gather from them, and
// builders compare a frame with the one before.
std::size_t Run::first_read() const {
  const auto past = static_cast<std::size_t>(std::max(denoisers_.front()->past(), 1));
  return position_ - std::min(position_, past);
}

void Run::read_frames() {
  try {
    for (std::size_t i = first_read(); i < plan_.frames.size(); ++i) {
      StageClock clock;
      ReadyFrame ready;
      ready.raw = std::make_shared<const RawFrame>(
          read_raw_frame(plan_.frames[i], plan_.layers, plan_.canvas));
      for (FrameBuilder& builder : builders_) {
        ready.views.push_back(std::make_unique<Frame>());
        builder.build(ready.raw, *ready.views.back());
      }
      ready.read_ms = clock.lap().wall_ms;
      if (!ready_.push(std::move(ready))) return;
    }
    ready_.close();
  } catch (...) {
    ready_.close(std::current_exception());
  }
}

bool Run::is_complete(std::size_t index) const {
  const std::vector<fs::path>& outputs = plan_.frames[index].outputs;
  return std::all_of(outputs.begin(), outputs.end(), is_complete_exr);
}

// False where the reader has stopped.
bool Run::push_frame() {
  std::optional<ReadyFrame> ready = ready_.pop();
  if (!ready) return false;
  for (std::size_t v = 0; v < denoisers_.size(); ++v) {
    std::vector<Planes<3>> emission;
    for (const FileLayer& layer : plan_.layers.views[v].emission) {
      emission.push_back(view_layer(ready->raw->at(layer)));
    }
    if (next_push_ < position_) {
      denoisers_[v]->push_past(*ready->views[v], emission);
    } else {
      denoisers_[v]->push(*ready->views[v], emission);
    }
  }
  if (next_push_ >= position_) {
    ready->views.clear();
    pushed_.push_back(std::move(*ready));
  }
  ++next_push_;
  if (next_push_ == plan_.frames.size()) {
    for (const auto& denoiser : denoisers_) denoiser->finish();
  }
  return true;
}

bool Run::is_checkpoint_due() {
  const std::chrono::duration<double> interval(settings_.checkpoint_seconds);
  if (Clock::now() - saved_ < interval) return false;
  saved_ = Clock::now();
  return true;
}

FinishedFrame Run::denoise(std::size_t index) {
  ReadyFrame& ready = pushed_.front();
  FinishedFrame finished;
  finished.raw = std::move(ready.raw);
  finished.index = index;
  finished.record.read_ms = ready.read_ms;
  finished.outputs.resize(plan_.frames[index].inputs.size());
  for (std::size_t v = 0; v < denoisers_.size(); ++v) {
    WindowDenoiser& denoiser = *denoisers_[v];
    if (!denoiser.step()) throw std::logic_error("a frame was lost");
    add_report(denoiser.report(), finished.record);
    StageClock clock;
    std::vector<const Planes<3>*> lights;
    for (int i = 0; i < denoiser.layers(); ++i) lights.push_back(&denoiser.output(i));
    const ViewPlan& view = plan_.layers.views[v];
    std::vector<const Planes<3>*> emission;
    for (std::size_t i = 0; i < view.emission.size(); ++i) {
      emission.push_back(&denoiser.emission(static_cast<int>(i)));
    }
    compose_view(*finished.raw, view, plan_.canvas, lights, emission, finished.outputs);
    finished.record.compose_ms += clock.lap().wall_ms;
  }
  pushed_.pop_front();
  return finished;
}

void Run::denoise_frames(OutputWriter& writer) {
  const auto ahead = static_cast<std::size_t>(plan_.lookahead);
  next_push_ = first_read();
  bool stops = false;
  for (std::size_t i = position_; i < plan_.frames.size() && !stops; ++i) {
    while (next_push_ < plan_.frames.size() && next_push_ <= i + ahead) {
      if (!push_frame()) return;
    }
    FinishedFrame finished = denoise(i);
    finished.is_written = !settings_.skip_existing || !is_complete(i);
    stops = callbacks_.interrupted();
    const bool is_last = i + 1 == plan_.frames.size();
    finished.is_checkpoint = !is_last && (is_checkpoint_due() || stops);
    if (!writer.push(std::move(finished))) return;
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
  OutputWriter writer(plan_, callbacks_, description_, totals_);
  std::thread reader([this] { read_frames(); });
  std::exception_ptr error;
  try {
    denoise_frames(writer);
  } catch (...) {
    error = std::current_exception();
  }
  ready_.close();
  reader.join();
  if (error) std::rethrow_exception(error);
  writer.finish();
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
