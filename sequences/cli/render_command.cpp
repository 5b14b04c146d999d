#include "sequences/cli/render_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>

#include "sequences/cli/job.h"
#include "sequences/pages/run_page.h"
#include "sequences/runs/open_scene.h"
#include "sequences/runs/render_plan.h"
#include "sequences/runs/run_description.h"
#include "sequences/runs/run_directory.h"
#include "sequences/runs/run_log.h"
#include "sequences/runs/run_totals.h"
#include "temporal/methods.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

using Clock = std::chrono::steady_clock;

// A checkpoint holds the whole history (67 MB at 1280x720 with 3 bases). Once in ten seconds keeps
// its cost under a few percent, and no crash costs more than ten seconds of work.
constexpr std::chrono::seconds kCheckpointInterval{10};

// The frame loop of one process.
class RenderRun {
 public:
  RenderRun(const RenderSettings& settings, const Job& job)
      : settings_(settings), job_(job), plan_(make_plan(settings)) {}

  int run();

 private:
  [[nodiscard]] Scene load() const;
  [[nodiscard]] RunHistory history() const { return {*denoiser_, direct_.get()}; }
  void say_what_comes(const FrameWriter& writer) const;
  // Renders frames from `position_` on, until the last one or an interrupt.
  void render(const Animation& animation, const Scene& scene, FrameWriter& writer);
  // Denoises direct light, antialiases the frame that the denoiser pulled last, if the picture is
  // written, and writes it.
  FrameOutput write_frame(LiveSource& source, const Planes<3>& indirect, FrameWriter& writer);
  int stopped() const;
  int finished() const;

  const RenderSettings& settings_;
  const Job& job_;
  RenderPlan plan_;
  std::unique_ptr<Denoiser> denoiser_;
  std::unique_ptr<DirectDenoiser> direct_;  // null: direct light stays noisy
  std::unique_ptr<RunDirectory> directory_;
  std::size_t position_ = 0;  // frames that are complete
  Planes<3> picture_;
  RunTotals totals_;
};

Scene RenderRun::load() const {
  std::vector<std::string> notes;
  Scene scene = open_scene({settings_.scene, settings_.environment}, notes);
  job_.say_notes(notes);
  return scene;
}

void RenderRun::say_what_comes(const FrameWriter& writer) const {
  const std::size_t count = plan_.frames.size();
  if (position_ == count) return job_.say(fmt::format("all {} frames are complete", count));
  std::string text = fmt::format("rendering {} frames, {} to {}", count - position_,
                                 writer.path(plan_.frames[position_]).string(),
                                 writer.path(plan_.frames.back()).string());
  if (settings_.resume) text += fmt::format("; {} complete before", position_);
  job_.say(text);
}

int RenderRun::run() {
  Scene scene = load();
  const RunDescription description = describe_run(settings_, plan_, scene);
  const auto animation = make_flythrough(scene, plan_.perturbation, plan_.render.extent);
  denoiser_ = make_denoiser(
      plan_.denoiser,
      {.extent = plan_.render.extent, .bases = plan_.bases, .without = plan_.without});
  if (plan_.denoises_direct) {
    direct_ = std::make_unique<DirectDenoiser>(
        DenoiserOptions{.extent = plan_.render.extent, .bases = plan_.bases});
  }
  directory_ = std::make_unique<RunDirectory>(settings_.directory, to_json_text(description));
  const std::string foreign = directory_->foreign_frames(plan_.frames);
  if (!foreign.empty()) job_.say_notes({foreign});
  if (settings_.resume) {
    position_ = directory_->resume(plan_.frames, history());
  } else {
    directory_->begin();
  }
  FrameWriter writer(directory_->path(), plan_.layers, file_attributes(description));
  say_what_comes(writer);
  render(*animation, scene, writer);
  return position_ < plan_.frames.size() ? stopped() : finished();
}

void RenderRun::render(const Animation& animation, const Scene& scene, FrameWriter& writer) {
  const auto start = Clock::now();
  RunLog log(directory_->path(), plan_.frames, position_);
  Progress progress = job_.progress(position_, plan_.frames.size());
  if (position_ == plan_.frames.size()) return;
  LiveSource source(scene, animation, plan_.render, plan_.frames, position_);
  auto saved = Clock::now();
  for (; position_ < plan_.frames.size() && !job_.interrupted(); ++position_) {
    const Planes<3>* indirect = denoiser_->step(source);
    if (!indirect) throw std::logic_error("the source ended before the last frame");
    const FrameOutput output = write_frame(source, *indirect, writer);
    log.append(denoiser_->report(), denoiser_->frame().spp, output);
    totals_.add(denoiser_->report(), output);
    progress.frame_done(plan_.frames[position_]);
    if (Clock::now() - saved < kCheckpointInterval) continue;
    directory_->save(position_ + 1, history());
    saved = Clock::now();
  }
  directory_->save(position_, history());
  totals_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
}

FrameOutput RenderRun::write_frame(LiveSource& source, const Planes<3>& indirect,
                                   FrameWriter& writer) {
  FrameOutput output;
  StageClock clock;
  const Frame& frame = denoiser_->frame();
  if (direct_) {
    direct_->step(frame, source.sun(), source.soft());
    output.direct = clock.lap();
  }
  const bool antialiases = plan_.antialias.mode != AntialiasMode::kNone &&
                           std::count(plan_.layers.begin(), plan_.layers.end(), Layer::kColor) > 0;
  if (antialiases) {
    output.picture = source.picture(plan_.antialias, frame, indirect, picture_,
                                    direct_ ? &direct_->output() : nullptr);
    output.antialias = clock.lap();
  }
  writer.write({frame, indirect, denoiser_->age(), antialiases ? &picture_ : nullptr,
                direct_ ? &direct_->output() : nullptr});
  output.write = clock.lap();
  return output;
}

int RenderRun::stopped() const {
  job_.say(fmt::format("stopped after {} of {} frames; to go on:\n  {}{}", position_,
                       plan_.frames.size(), job_.command_line(),
                       settings_.resume ? "" : " --resume"));
  return kInterrupted;
}

int RenderRun::finished() const {
  write_run_page(directory_->path());
  job_.print_results(totals_.to_json(directory_->path()), totals_.to_text(directory_->path()));
  return kSuccess;
}

void add_picture_options(CLI::App& command, RenderSettings& settings) {
  command
      .add_option("scene", settings.scene,
                  "Name of a built-in scene (see `eigenlight scenes`), or a file: scene.json, "
                  ".gltf, .glb or .obj")
      ->required();
  command.add_option("-o,--output", settings.directory, "Directory for frames, logs and page")
      ->required();
  command.add_option("--frames", settings.frames, "Such as 7, 0-47, 5-1, 1-100x5 or 1-9,20")
      ->capture_default_str();
  command.add_option("--size", settings.size, "Width and height in pixels")->capture_default_str();
  command.add_option(
      "--spp", settings.spp,
      fmt::format("Samples of indirect light per pixel [3; reference: {}]", kReferenceSpp));
  command.add_option("--direct-spp", settings.direct_spp,
                     fmt::format("Samples of direct light per pixel [{}; reference: {}]",
                                 RenderOptions{}.direct_spp, kReferenceDirectSpp));
  command.add_option("--bounces", settings.bounces, "Bounces of indirect light")
      ->capture_default_str();
  command.add_option("--seed", settings.seed, "Seed of the noise")->capture_default_str();
  command
      .add_option(
          "--perturb", settings.perturb,
          "What changes: none, lights, objects, all, or step[:FRAME], one jump of the light")
      ->capture_default_str();
  command.add_flag("--environment", settings.environment,
                   "Light a scene.json by its environment map instead of its suns and sky");
}

void add_run_options(CLI::App& command, RenderSettings& settings) {
  command.add_option("--method", settings.method, "Denoiser; see `eigenlight methods`")
      ->capture_default_str();
  command.add_option("--without", settings.without,
                     "Comma-separated parts of the method to turn off; see `eigenlight methods "
                     "--parts`");
  command.add_option("--bases", settings.bases, "Bases per pixel, 1 to 8")->capture_default_str();
  command
      .add_option("--direct", settings.direct,
                  "Direct light in the picture: denoised, or noisy as it is sampled")
      ->capture_default_str();
  command
      .add_option("--aa", settings.antialias,
                  "Antialiasing of the layer color: none, lookup, sraa, sraa-geometry or "
                  "supersample:N")
      ->capture_default_str();
  command.add_option("--layers", settings.layers,
                     "Comma-separated layers to write [all]: " + format_layers(parse_layers("")));
  command.add_flag("--resume", settings.resume, "Go on where an interrupted run stopped");
}

struct RenderCommand {
  RenderSettings settings;
  JobOptions job;
};

}  // namespace

Command add_render_command(CLI::App& app) {
  CLI::App* parser = app.add_subcommand("render", "Render and denoise a flythrough");
  const auto command = std::make_shared<RenderCommand>();
  add_picture_options(*parser, command->settings);
  add_run_options(*parser, command->settings);
  add_job_options(*parser, command->job, "Print the summary as JSON");
  return {parser, [command](const Console& console) {
            const Job job(command->job, console);
            return RenderRun(command->settings, job).run();
          }};
}

}  // namespace eigenlight
