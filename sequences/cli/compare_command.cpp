#include "sequences/cli/compare_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sequences/cli/compare_options.h"
#include "sequences/cli/compare_output.h"
#include "sequences/cli/compare_paper.h"
#include "sequences/cli/compare_recorded.h"
#include "sequences/compare/antialias_run.h"
#include "sequences/compare/compare_pictures.h"
#include "sequences/compare/compare_run.h"
#include "sequences/compare/recorded_plan.h"
#include "sequences/files/file_pattern.h"
#include "sequences/runs/open_scene.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json shared_identity(const ComparePlan& plan) {
  return {{"program", program_hash()}, {"width", plan.extent.width}, {"height", plan.extent.height},
          {"bases", plan.bases},       {"bounces", plan.bounces},    {"seed", plan.seed},
          {"frames", plan.frames},     {"measured", plan.measured}};
}

Json cell_identity(const ReferenceCache& references, const Contender& contender, int spp) {
  Json json = {{"references", references.path().filename().string()},
               {"spp", spp},
               {"label", contender.label},
               {"method", contender.method},
               {"without", contender.without}};
  if (contender.external) {
    json["command"] = contender.external->command;
    json["time"] = contender.external->time_pattern;
  }
  if (contender.antialias) json["antialias"] = format_antialias(*contender.antialias);
  return json;
}

// A scene while it is compared on.
struct OpenCase {
  Scene scene;
  std::uint64_t hash = 0;
  std::unique_ptr<Animation> animation;

  [[nodiscard]] AnimatedScene animated() const { return {scene, *animation}; }
};

class CompareJob {
 public:
  CompareJob(const CompareSettings& settings, const Job& job)
      : job_(job), markdown_(settings.markdown), plan_(make_compare_plan(settings)) {
    // A name that is wrong is told before the first scene is measured for hours.
    for (const CompareCase& one : plan_.cases) check_scene({one.scene, plan_.environment});
  }

  int run() {
    const CellStore store(plan_.directory / "cells", shared_identity(plan_));
    std::vector<CaseResults> results;
    std::vector<PageGallery> galleries;
    for (const CompareCase& one : plan_.cases) {
      const OpenCase open = open_case(one);
      const ReferenceCache references(plan_.cache, identity_of(one, open));
      CaseResults of_case{one, open.scene.title, open.hash, references.path().string(), {}};
      if (!complete_references(one, open, references)) return job_.stopped();
      for (const int spp : plan_.spp) {
        if (!measure({one, open, references, spp}, store, of_case)) return job_.stopped();
      }
      const ComparePictures pictures = scene_pictures(
          plan_, references, plan_.directory / "frames" / one.name, open.scene.exposure);
      galleries.push_back(compare_gallery(pictures));
      write_crops(pictures, one.name, job_);
      results.push_back(std::move(of_case));
    }
    write_comparison(plan_, results, std::move(galleries), markdown_, job_);
    return kSuccess;
  }

 private:
  struct Task {
    const CompareCase& one;
    const OpenCase& open;
    const ReferenceCache& references;
    int spp;
  };

  [[nodiscard]] RunControl control(Progress& progress) const {
    return {[&progress](int frame) { progress.frame_done(frame); },
            [this] { return job_.interrupted(); }};
  }
  [[nodiscard]] OpenCase open_case(const CompareCase& one) const;
  [[nodiscard]] ReferenceIdentity identity_of(const CompareCase& one, const OpenCase& open) const;
  [[nodiscard]] bool complete_references(const CompareCase& one, const OpenCase& open,
                                         const ReferenceCache& references) const;
  [[nodiscard]] fs::path pictures_of(const Task& task) const;
  [[nodiscard]] bool has_pictures(const Task& task, const Contender& contender) const;
  [[nodiscard]] bool measure(const Task& task, const CellStore& store, CaseResults& results) const;
  [[nodiscard]] bool measure_missing(const Task& task, const std::vector<const Contender*>& missing,
                                     const CellStore& store) const;

  const Job& job_;
  std::string markdown_;  // as add_markdown_option() leaves it
  ComparePlan plan_;
};

OpenCase CompareJob::open_case(const CompareCase& one) const {
  std::vector<std::string> notes;
  OpenCase open;
  open.scene = open_scene({one.scene, plan_.environment}, notes);
  job_.say_notes(notes);
  open.hash = scene_hash(open.scene);
  open.animation = make_flythrough(open.scene, one.perturbation, plan_.extent);
  return open;
}

ReferenceIdentity CompareJob::identity_of(const CompareCase& one, const OpenCase& open) const {
  ReferenceIdentity identity{one.name,      open.hash,           one.perturb, plan_.extent,
                             plan_.bounces, plan_.reference_spp, plan_.seed,  0};
  RenderOptions options;
  options.extent = plan_.extent;
  options.bounces = plan_.bounces;
  if (plan_.is_antialiasing()) identity.antialias = kAntialiasReference;
  identity.is_whole = plan_.is_whole;
  identity.renderer =
      renderer_hash(open.animated(), options, identity.antialias, identity.is_whole);
  return identity;
}

bool CompareJob::complete_references(const CompareCase& one, const OpenCase& open,
                                     const ReferenceCache& references) const {
  for (const ReferenceCache::Half half : ReferenceCache::kHalves) {
    const std::vector<int> missing = references.missing(half, plan_.measured);
    if (missing.empty()) continue;
    job_.say(fmt::format("{}: reference {} of 2, {} spp, {} frames", one.name,
                         half == ReferenceCache::Half::kA ? 1 : 2, plan_.reference_spp,
                         missing.size()));
    Progress progress = job_.progress(0, missing.size());
    references.render(half, missing, open.animated(), control(progress));
    if (job_.interrupted()) return false;
  }
  return true;
}

// Nowhere but at the sample count that is shown.
fs::path CompareJob::pictures_of(const Task& task) const {
  return task.spp == plan_.shown_spp() ? plan_.directory / "frames" / task.one.name : fs::path();
}

bool CompareJob::has_pictures(const Task& task, const Contender& contender) const {
  const fs::path folder = pictures_of(task);
  if (folder.empty()) return true;
  return std::all_of(plan_.measured.begin(), plan_.measured.end(), [&](int frame) {
    return fs::exists(folder / contender.label / FilePattern(kFramePattern).name(frame));
  });
}

bool CompareJob::measure(const Task& task, const CellStore& store, CaseResults& results) const {
  const auto load = [&](const Contender& contender) {
    return store.load(cell_identity(task.references, contender, task.spp));
  };
  std::vector<const Contender*> missing;
  for (const Contender& contender : plan_.contenders) {
    if (!load(contender) || !has_pictures(task, contender)) missing.push_back(&contender);
  }
  if (!missing.empty() && !measure_missing(task, missing, store)) return false;
  for (const Contender& contender : plan_.contenders) {
    std::optional<Cell> cell = load(contender);
    if (!cell) throw std::logic_error("a cell that was saved is there");
    results.cells.push_back(std::move(*cell));
  }
  return !job_.interrupted();
}

bool CompareJob::measure_missing(const Task& task, const std::vector<const Contender*>& missing,
                                 const CellStore& store) const {
  job_.say(fmt::format("{}, {} spp: {} methods, {} frames", task.one.name, task.spp, missing.size(),
                       plan_.frames.size()));
  Progress progress = job_.progress(0, plan_.frames.size());
  const CompareGroup group{task.open.animated(),       task.references, task.spp,
                           task.open.scene.exposure,   missing,         pictures_of(task),
                           plan_.directory / "scratch"};
  const auto run = plan_.is_antialiasing() ? run_antialias_group : run_group;
  const auto cells = run(plan_, group, control(progress));
  if (!cells) return false;
  for (std::size_t i = 0; i < missing.size(); ++i) {
    store.save(cell_identity(task.references, *missing[i], task.spp), (*cells)[i]);
  }
  return true;
}

}  // namespace

Command add_compare_command(CLI::App& app) {
  CLI::App* parser =
      app.add_subcommand("compare", "Compare error, time and memory of methods on the same frames");
  const auto options = std::make_shared<CompareOptions>();
  add_compare_options(*parser, *options);
  return {parser, [options](const Console& console) {
            const CompareSettings& settings = options->settings;
            const Job job(options->job, console);
            if (!settings.paper.empty()) return compare_paper(settings, job);
            return is_recorded(settings) ? compare_recorded(settings, job)
                                         : CompareJob(settings, job).run();
          }};
}

}  // namespace eigenlight
