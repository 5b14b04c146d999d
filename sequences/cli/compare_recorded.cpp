#include "sequences/cli/compare_recorded.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "sequences/cli/command.h"
#include "sequences/cli/compare_output.h"
#include "sequences/compare/compare_results.h"
#include "sequences/compare/recorded_run.h"
#include "sequences/denoise/plan_text.h"
#include "sequences/files/file_pattern.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json identity_of(const Contender& contender) {
  Json json = {{"label", contender.label}, {"method", contender.method}};
  if (contender.external) {
    json["command"] = contender.external->command;
    json["time"] = contender.external->time_pattern;
  }
  return json;
}

class RecordedJob {
 public:
  RecordedJob(const CompareSettings& settings, const Job& job)
      : job_(job), markdown_(settings.markdown), plan_(make_compare_plan(settings)) {
    shared_ = {{"program", program_hash()}, {"recorded", recorded_identity(plan_)}};
    const std::string text = shared_.dump();
    // Frames of another run must not be taken for those of this one.
    work_ = plan_.directory / "denoised" /
            fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
    plan_.recorded->denoise.files.output = work_.string();
  }

  int run() {
    const DenoisePlan denoise = plan_denoising(plan_.recorded->denoise);
    for (const std::string& warning : denoise.warnings) job_.say("eigenlight: note: " + warning);
    const CellStore store(plan_.directory / "cells", shared_);
    const float exposure = recorded_exposure(plan_);
    RecordedRun run(plan_, denoise, work_, exposure);
    CaseResults results{
        plan_.cases.front(), plan_.recorded->denoise.files.inputs.front(), 0, "", {}};
    for (const Contender& contender : plan_.contenders) {
      if (!complete(contender, run, store)) return job_.stopped();
      std::optional<Cell> cell = store.load(identity_of(contender));
      if (!cell) throw std::logic_error("a cell that was saved is there");
      results.cells.push_back(std::move(*cell));
    }
    const ComparePictures pictures = recorded_pictures(plan_, exposure);
    write_crops(pictures, plan_.cases.front().name, job_);
    write_comparison(plan_, {results}, {compare_gallery(pictures)}, markdown_, job_);
    std::error_code error;
    fs::remove_all(plan_.directory / "denoised", error);
    return kSuccess;
  }

 private:
  // False if it was stopped.
  [[nodiscard]] bool complete(const Contender& contender, RecordedRun& run,
                              const CellStore& store) const {
    if (store.load(identity_of(contender)) && has_pictures(contender)) return !job_.interrupted();
    const std::size_t frames = frames_of(contender);
    job_.say(fmt::format("{}: {}, {} frames", plan_.cases.front().name, contender.label, frames));
    Progress progress = job_.progress(0, frames);
    const RunControl control{[&progress](int frame) { progress.frame_done(frame); },
                             [this] { return job_.interrupted(); }};
    const std::optional<Cell> cell = run.run(contender, control);
    if (!cell) return false;
    store.save(identity_of(contender), *cell);
    return true;
  }
  // Our own methods see all frames; what is only copied, or goes to a program, are those measured.
  [[nodiscard]] std::size_t frames_of(const Contender& contender) const {
    const bool sees_all = !contender.external && contender.method != "noisy";
    return sees_all ? plan_.frames.size() : plan_.measured.size();
  }
  [[nodiscard]] bool has_pictures(const Contender& contender) const {
    const FilePattern pattern(kFramePattern);
    return std::all_of(plan_.measured.begin(), plan_.measured.end(), [&](int frame) {
      return fs::exists(recorded_folder(plan_, contender) / pattern.name(frame));
    });
  }

  const Job& job_;
  std::string markdown_;  // as add_markdown_option() leaves it
  ComparePlan plan_;
  Json shared_;
  fs::path work_;
};

}  // namespace

int compare_recorded(const CompareSettings& settings, const Job& job) {
  return RecordedJob(settings, job).run();
}

}  // namespace eigenlight
