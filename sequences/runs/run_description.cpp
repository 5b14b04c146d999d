#include "sequences/runs/run_description.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "frame/bad_file.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/perturbation.h"
#include "sequences/files/version.h"
#include "sequences/runs/flythrough.h"
#include "sequences/runs/open_scene.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Json parse_object(std::string_view text, std::string_view whose) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) {
    throw BadFile(fmt::format("the description of {} is not a JSON object", whose));
  }
  return json;
}

std::string show(const Json& json, const std::string& key) {
  if (!json.contains(key)) return "not given";
  return json[key].is_string() ? json[key].get<std::string>() : json[key].dump();
}

}  // namespace

RunDescription describe_run(const RenderSettings& settings, const RenderPlan& plan,
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
  run.direct = plan.denoises_direct ? "denoised" : "noisy";
  run.antialias = format_antialias(plan.antialias);
  run.layers = format_layers(plan.layers);
  run.exposure = scene.exposure;
  return run;
}

std::string to_json_text(const RunDescription& run) {
  const Json json{{"software", program_version()},
                  {"scene", run.scene},
                  {"title", run.title},
                  {"scene_hash", fmt::format("{:016x}", run.scene_hash)},
                  {"environment", run.environment},
                  {"frames", format_frame_range(run.frames)},
                  {"frame_count", run.frames.size()},
                  {"width", run.extent.width},
                  {"height", run.extent.height},
                  {"spp", run.spp},
                  {"direct_spp", run.direct_spp},
                  {"bounces", run.bounces},
                  {"method", run.method},
                  {"without", run.without},
                  {"bases", run.bases},
                  {"seed", run.seed},
                  {"perturb", run.perturb},
                  {"direct", run.direct},
                  {"antialias", run.antialias},
                  {"layers", run.layers},
                  {"exposure", run.exposure},
                  {"frames_per_second", kFramesPerSecond}};
  return json.dump(2) + "\n";
}

std::vector<ExrAttribute> file_attributes(const RunDescription& run) {
  return {{"Software", program_version()},      {"eigenlight.scene", run.scene},
          {"eigenlight.method", run.method},    {"eigenlight.without", run.without},
          {"eigenlight.bases", run.bases},      {"eigenlight.spp", run.spp},
          {"eigenlight.bounces", run.bounces},  {"eigenlight.seed", fmt::format("{}", run.seed)},
          {kPerturbAttribute, run.perturb},     {"eigenlight.direct_spp", run.direct_spp},
          {"eigenlight.direct", run.direct},    {"eigenlight.antialias", run.antialias},
          {"eigenlight.exposure", run.exposure}};
}

std::string first_difference(std::string_view there, std::string_view here) {
  const Json a = parse_object(there, "the other run");
  const Json b = parse_object(here, "this run");
  for (const Json& json : {a, b}) {
    for (const auto& [key, value] : json.items()) {
      if (a.contains(key) && b.contains(key) && a[key] == b[key]) continue;
      return fmt::format("{} is {} there, {} here", key, show(a, key), show(b, key));
    }
  }
  return "";
}

}  // namespace eigenlight
