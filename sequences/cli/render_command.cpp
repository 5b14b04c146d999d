#include "sequences/cli/render_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "frame/tiles.h"
#include "sequences/cli/interrupt.h"
#include "sequences/cli/progress.h"
#include "sequences/files/version.h"
#include "sequences/pages/report.h"
#include "sequences/runs/run_directory.h"
#include "sequences/runs/run_log.h"
#include "sequences/runs/scene_source.h"
#include "temporal/methods.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

using Clock = std::chrono::steady_clock;

// A checkpoint holds the whole history (67 MB at 1280x720 with 3 bases). Once in ten seconds keeps
// its cost under a few percent, and no crash costs more than ten seconds of work.
constexpr std::chrono::seconds kCheckpointInterval{10};

RunDescription describe(const RenderSettings& settings, const RenderPlan& plan,
                        const Scene& scene) {
  RunDescription run;
  run.scene = settings.scene;
  run.title = scene.title.empty() ? scene.name : scene.title;
  run.scene_hash = scene_hash(scene);
  run.environment = settings.environment;
  run.frames = plan.frames;
  run.extent = plan.render.extent;
  run.spp = plan.render.spp;
  run.direct_spp = plan.render.direct_spp;
  run.bounces = plan.render.bounces;
  run.method = plan.method;
  run.without = fmt::format("{}", fmt::join(plan.without, ","));
  run.bases = plan.bases;
  run.seed = plan.render.seed;
  run.perturb = plan.perturb;
  run.antialias = format_antialias(plan.antialias);
  run.layers = format_layers(plan.layers);
  run.exposure = scene.exposure;
  return run;
}

// What every frame file says about the run.
std::vector<ExrAttribute> file_attributes(const RunDescription& run) {
  return {{"Software", program_version()},      {"eigenlight.scene", run.scene},
          {"eigenlight.method", run.method},    {"eigenlight.without", run.without},
          {"eigenlight.bases", run.bases},      {"eigenlight.spp", run.spp},
          {"eigenlight.bounces", run.bounces},  {"eigenlight.seed", fmt::format("{}", run.seed)},
          {kPerturbAttribute, run.perturb},     {"eigenlight.antialias", run.antialias},
          {"eigenlight.exposure", run.exposure}};
}

Progress::Style progress_style(const RenderSettings& settings, const Console& console) {
  if (settings.quiet) return Progress::Style::kNone;
  return console.err_is_terminal ? Progress::Style::kBar : Progress::Style::kLines;
}

// The frame loop of one process.
class RenderJob {
 public:
  RenderJob(const RenderSettings& settings, const Console& console)
      : settings_(settings),
        console_(console),
        plan_(make_plan(settings)),
        interrupt_(settings.quiet ? InterruptGuard::Notice::kSilent
                                  : InterruptGuard::Notice::kStderr) {
    set_thread_count(settings.threads);
  }

  int run();

 private:
  void say(const std::string& text) const {
    if (!settings_.quiet) console_.err << text << '\n' << std::flush;
  }
  Scene load_scene_and_say() const;
  void say_what_comes(const FrameWriter& writer) const;
  // Renders frames from `position_` on, until the last one or an interrupt.
  void render(const Animation& animation, const Scene& scene, FrameWriter& writer);
  // Antialiases the frame that the denoiser pulled last, if that is asked for and will be seen.
  FrameOutput write_frame(LiveSource& source, const Planes<3>& indirect, FrameWriter& writer);
  int stopped() const;
  int finished();

  const RenderSettings& settings_;
  const Console& console_;
  RenderPlan plan_;
  InterruptGuard interrupt_;
  std::unique_ptr<Denoiser> denoiser_;
  std::unique_ptr<RunDirectory> directory_;
  std::size_t position_ = 0;
  Planes<3> picture_;
  RunTotals totals_;
};

Scene RenderJob::load_scene_and_say() const {
  std::vector<std::string> notes;
  Scene scene = open_scene({settings_.scene, settings_.environment}, notes);
  for (const std::string& note : notes) say("eigenlight: note: " + note);
  return scene;
}

void RenderJob::say_what_comes(const FrameWriter& writer) const {
  const std::size_t count = plan_.frames.size();
  if (position_ == count) return say(fmt::format("all {} frames are complete", count));
  std::string text = fmt::format("rendering {} frames, {} to {}", count - position_,
                                 writer.path(plan_.frames[position_]).string(),
                                 writer.path(plan_.frames.back()).string());
  if (settings_.resume) text += fmt::format("; {} complete before", position_);
  say(text);
}

int RenderJob::run() {
  Scene scene = load_scene_and_say();
  const RunDescription description = describe(settings_, plan_, scene);
  const auto animation = make_flythrough(scene, plan_.perturbation, plan_.render.extent);
  denoiser_ = make_denoiser(
      plan_.denoiser,
      {.extent = plan_.render.extent, .bases = plan_.bases, .without = plan_.without});
  directory_ = std::make_unique<RunDirectory>(settings_.directory, to_json_text(description));
  if (settings_.resume) {
    position_ = directory_->resume(plan_.frames, *denoiser_);
  } else {
    directory_->begin();
  }
  FrameWriter writer(directory_->path(), plan_.layers, file_attributes(description));
  say_what_comes(writer);
  render(*animation, scene, writer);
  return position_ < plan_.frames.size() ? stopped() : finished();
}

void RenderJob::render(const Animation& animation, const Scene& scene, FrameWriter& writer) {
  const auto start = Clock::now();
  RunLog log(directory_->path(), plan_.frames, position_);
  Progress progress(console_.err, progress_style(settings_, console_), position_,
                    plan_.frames.size());
  if (position_ == plan_.frames.size()) return;
  LiveSource source(scene, animation, plan_.render, plan_.frames, position_);
  auto saved = Clock::now();
  for (; position_ < plan_.frames.size() && !interrupt_.interrupted(); ++position_) {
    const Planes<3>* indirect = denoiser_->step(source);
    if (!indirect) throw std::logic_error("the source ended before the last frame");
    const FrameOutput output = write_frame(source, *indirect, writer);
    log.append(denoiser_->report(), denoiser_->frame().spp, output);
    totals_.add(denoiser_->report(), output);
    progress.frame_done(plan_.frames[position_]);
    if (Clock::now() - saved < kCheckpointInterval) continue;
    directory_->save(position_ + 1, *denoiser_);
    saved = Clock::now();
  }
  directory_->save(position_, *denoiser_);
  totals_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
}

FrameOutput RenderJob::write_frame(LiveSource& source, const Planes<3>& indirect,
                                   FrameWriter& writer) {
  FrameOutput output;
  StageClock clock;
  const Frame& frame = denoiser_->frame();
  const bool antialiases = plan_.antialias.mode != AntialiasMode::kNone &&
                           std::count(plan_.layers.begin(), plan_.layers.end(), Layer::kColor) > 0;
  if (antialiases) {
    output.picture = source.picture(plan_.antialias, frame, indirect, picture_);
    output.antialias = clock.lap();
  }
  writer.write({frame, indirect, denoiser_->age(), antialiases ? &picture_ : nullptr});
  output.write = clock.lap();
  return output;
}

int RenderJob::stopped() const {
  say(fmt::format("stopped after {} of {} frames; to go on:\n  {}{}", position_,
                  plan_.frames.size(), console_.command_line, settings_.resume ? "" : " --resume"));
  return kInterruptedStatus;
}

int RenderJob::finished() {
  write_report(directory_->path());
  if (settings_.json) {
    console_.out << totals_.to_json(directory_->path()) << std::flush;
  } else if (!settings_.quiet) {
    console_.out << totals_.to_text(directory_->path()) << std::flush;
  }
  return 0;
}

}  // namespace

int render_command(const RenderSettings& settings, const Console& console) {
  return RenderJob(settings, console).run();
}

}  // namespace eigenlight
