#include "sequences/compare/recorded_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "frame/bad_file.h"
#include "sequences/compare/recorded_method.h"
#include "sequences/compare/recorded_plan.h"
#include "sequences/files/directory.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/file_pattern.h"
#include "sequences/files/frame_range.h"
#include "sequences/metrics/evaluate.h"
#include "sequences/metrics/layer_sequence.h"
#include "sequences/pages/auto_exposure.h"
#include "sequences/runs/render_plan.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Name, size and time of a file; all 0 where there is none.
Json stamp(const fs::path& path) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  if (error) return {path.string(), 0, 0};
  return {path.string(), bytes, fs::last_write_time(path, error).time_since_epoch().count()};
}

// The layer `best`, else `other`, of any of the inputs.
Planes<3> read_guide(const std::vector<fs::path>& files, const char* best, const char* other,
                     const ExternalMethod& method, const char* place) {
  for (const char* layer : {best, other}) {
    for (const fs::path& path : files) {
      const ExrReader reader(path);
      if (reader.has_layer(layer)) return reader.read_planes<3>(layer);
    }
  }
  throw BadFile(fmt::format("external '{}': {} has no layer for {{{}}}", method.name,
                            files.front().string(), place));
}

Evaluation measure(const ComparePlan& plan, const Contender& contender, float exposure) {
  EvaluateOptions options;
  options.test = (recorded_folder(plan, contender) / kFramePattern).string();
  options.test_layer = "";
  options.reference = plan.recorded->reference;
  options.reference_b = plan.recorded->reference_b;
  options.layer = plan.recorded->layer;
  options.frames = format_frame_range(plan.measured);
  options.metrics.exposure = exposure;
  options.takes_all_pixels = true;  // a beauty has light in front of the sky as well
  options.skips_bad = true;         // pixels with NaN or Inf; they are counted
  Evaluation found = evaluate(options);
  if (!found.skipped.empty()) throw std::runtime_error(found.skipped.front().reason);
  return found;
}

}  // namespace

fs::path recorded_folder(const ComparePlan& plan, const Contender& contender) {
  return plan.directory / "frames" / plan.cases.front().name / contender.label;
}

Json recorded_identity(const ComparePlan& plan) {
  const RecordedShot& shot = *plan.recorded;
  const DenoiseSettings& denoise = shot.denoise;
  Json json = {{"layer", shot.layer},
               {"map", denoise.layers.map},
               {"keep", denoise.layers.keep},
               {"skip", denoise.layers.skip},
               {"motion", denoise.guides.motion},
               {"cuts", denoise.cuts},
               {"references", {shot.reference, shot.reference_b}},
               {"measured", plan.measured},
               {"files", Json::array()}};
  const fs::path input(denoise.files.inputs.front());
  json["files"].push_back(stamp(denoise.guides.camera));
  json["files"].push_back(stamp(input.parent_path() / (plan.cases.front().name + ".camera.json")));
  for (const std::string& name : denoise.files.inputs) {
    const SequenceName sequence(name);
    for (const int frame : plan.frames) json["files"].push_back(stamp(sequence.path(frame)));
  }
  for (const std::string& text : {shot.reference, shot.reference_b}) {
    if (text.empty()) continue;
    const LayerSequence sequence = parse_layer_sequence(text);
    for (const int f : plan.measured) json["files"].push_back(stamp(sequence.name.path(f)));
  }
  return json;
}

RecordedRun::RecordedRun(const ComparePlan& plan, const DenoisePlan& denoise, fs::path work,
                         float exposure)
    : plan_(plan), denoise_(denoise), work_(std::move(work)), exposure_(exposure) {
  make_directory(work_);
}

bool RecordedRun::is_measured(int frame) const {
  return std::binary_search(plan_.measured.begin(), plan_.measured.end(), frame);
}

void RecordedRun::keep(const Contender& contender, int frame, const Planes<3>& layer) const {
  const fs::path folder = recorded_folder(plan_, contender);
  make_directory(folder);
  write_float_layer(folder / FilePattern(kFramePattern).name(frame), "RGB", layer);
}

double RecordedRun::files_ms() {
  if (!files_ms_) {
    const fs::path folder = work_ / "files";
    make_directory(folder);
    files_ms_ = files_cpu_ms(denoise_, plan_.measured, folder);
    std::error_code error;
    fs::remove_all(folder, error);
  }
  return *files_ms_;
}

bool RecordedRun::run_denoiser(const Contender& contender, const RunControl& control, Cost& cost) {
  cost.files_ms = files_ms();
  StageClock clock;
  const DenoiseTotals totals =
      run_denoising(plan_.recorded->denoise, denoise_, {control.stops, control.frame_done});
  const double ms =
      clock.lap().cpu_ms / static_cast<double>(std::max<std::size_t>(totals.frames, 1));
  if (control.stops()) return false;
  cost.method_ms = std::max(ms - cost.files_ms, 0.0);
  for (const FrameFiles& files : denoise_.frames) {
    if (!is_measured(files.frame)) continue;
    keep(contender, files.frame, read_shot_layer(files.outputs, plan_.recorded->layer));
  }
  return true;
}

bool RecordedRun::run_method(const Contender& contender, const RunControl& control, Cost& cost) {
  cost.files_ms = files_ms();
  RecordedMethod method(contender.method, denoise_);
  const fs::path folder = work_ / "method";
  make_directory(folder);
  for (const FrameFiles& files : denoise_.frames) {
    const auto raw =
        std::make_shared<const RawFrame>(read_raw_frame(files, denoise_.layers, denoise_.canvas));
    cost.method_ms += method.step(raw);
    if (is_measured(files.frame)) {
      const auto written = write_channels(*raw, files, method.compose(), folder);
      keep(contender, files.frame, read_shot_layer(written, plan_.recorded->layer));
    }
    control.frame_done(files.frame);
    if (control.stops()) return false;
  }
  cost.method_ms /= static_cast<double>(denoise_.frames.size());
  std::error_code error;
  fs::remove_all(folder, error);
  return true;
}

bool RecordedRun::run_program(const Contender& contender, const RunControl& control,
                              Cost& cost) const {
  const ExternalMethod& method = *contender.external;
  const fs::path folder = work_ / "program";
  std::error_code error;
  fs::remove_all(folder, error);
  make_directory(folder);
  const ExternalRun run(method, {plan_.frames, plan_.measured}, folder);
  for (const FrameFiles& files : denoise_.frames) {
    if (!run.takes(files.frame)) continue;
    const Planes<3> color = read_shot_layer(files.inputs, plan_.recorded->layer);
    Planes<3> albedo, normal;
    if (method.wants("albedo")) {
      albedo = read_guide(files.inputs, "Denoising Albedo", "albedo", method, "albedo");
    }
    if (method.wants("normal")) {
      normal = read_guide(files.inputs, "N", "Denoising Normal", method, "normal");
    }
    run.add({files.frame, color, albedo, normal});
    if (control.stops()) return false;
  }
  ExternalCost spent;
  if (!run.run(control.stops, spent)) return false;
  cost.method_ms = spent.ms;
  for (const int frame : plan_.measured) {
    keep(contender, frame, run.output(frame, plan_.extent));
    control.frame_done(frame);
  }
  fs::remove_all(folder, error);
  return true;
}

void RecordedRun::copy_inputs(const Contender& contender, const RunControl& control) const {
  for (const FrameFiles& files : denoise_.frames) {
    if (!is_measured(files.frame)) continue;
    keep(contender, files.frame, read_shot_layer(files.inputs, plan_.recorded->layer));
    control.frame_done(files.frame);
  }
}

std::optional<Cell> RecordedRun::run(const Contender& contender, const RunControl& control) {
  Cost cost;
  bool is_done = true;
  if (contender.external) {
    is_done = run_program(contender, control, cost);
  } else if (contender.method == kDefaultMethod) {
    is_done = run_denoiser(contender, control, cost);
  } else if (contender.method == "noisy") {
    copy_inputs(contender, control);
  } else {
    is_done = run_method(contender, control, cost);
  }
  if (!is_done) return std::nullopt;
  Evaluation found = measure(plan_, contender, exposure_);
  Cell cell;
  cell.contender = contender.label;
  cell.frames = std::move(found.frames);
  cell.files_ms = cost.files_ms;
  cell.denoise_ms = cost.method_ms;
  cell.bad_pixels = found.bad_pixels;
  return cell;
}

ComparePictures recorded_pictures(const ComparePlan& plan, float exposure) {
  const RecordedShot& shot = *plan.recorded;
  const LayerSequence a = parse_layer_sequence(shot.reference);
  const LayerSequence b = shot.reference_b.empty() ? a : parse_layer_sequence(shot.reference_b);
  return {plan, exposure,
          [a, b, layer = shot.layer](ReferenceCache::Half half, int frame) {
            return read_layer(half == ReferenceCache::Half::kA ? a : b, frame, layer);
          },
          [&plan](const Contender& contender, int frame) {
            const FilePattern pattern(kFramePattern);
            const ExrReader reader(recorded_folder(plan, contender) / pattern.name(frame));
            return reader.read_planes<3>("");
          }};
}

float recorded_exposure(const ComparePlan& plan) {
  const LayerSequence reference = parse_layer_sequence(plan.recorded->reference);
  return auto_exposure(read_layer(reference, plan.measured.front(), plan.recorded->layer));
}

}  // namespace eigenlight
