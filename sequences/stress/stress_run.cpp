#include "sequences/stress/stress_run.h"

#include <fmt/format.h>

#include <cmath>

#include "sequences/files/checkpoint.h"
#include "sequences/files/directory.h"
#include "sequences/files/exr_io.h"
#include "temporal/methods.h"

namespace eigenlight {

void StressLog::note(double figure, std::string_view what) {
  if (std::isnan(worst_) || std::isless(figure, worst_)) return;  // NaN is noted
  if (figure == worst_ && worst_step_ > 0) return;  // keeps the first of equal figures
  worst_ = figure;
  worst_what_ = what;
  worst_step_ = steps_;
}

StressRun::StressRun(StressLog& log, AnalyticOptions options, std::string_view method, int bases)
    : log_(log),
      source_([&] {
        options.seed = hash_key(log.seed(), options.seed);
        return options;
      }()),
      denoiser_(make_denoiser(method, {options.extent, bases})) {}

const Planes<3>* StressRun::step() {
  ++log_.steps_;
  const bool recorded = log_.recording_ && log_.recording_->step == log_.steps_;
  const Planes<3>* picture = recorded ? recorded_step() : denoiser_->step(source_);
  if (!picture) {
    --log_.steps_;  // the sequence had ended
    return nullptr;
  }
  return picture_ = picture;
}

const Planes<3>* StressRun::recorded_step() {
  const auto& directory = log_.recording_->directory;
  make_directory(directory);
  if (picture_) write("before");
  StateWriter state;
  denoiser_->save(state);
  write_checkpoint(directory / "state.bin",
                   {"stress", static_cast<std::uint64_t>(log_.steps_ - 1), state.bytes()});
  const Planes<3>* picture = denoiser_->step(source_);
  if (picture) {
    picture_ = picture;
    write("frame");
  }
  return picture;
}

void StressRun::write(std::string_view name) const {
  constexpr std::string_view kAxes = "RGBXYZ";
  std::vector<ExrChannel> channels;
  const auto add = [&](std::string_view layer, const auto& planes, std::size_t first_axis) {
    for (std::size_t c = 0; c < planes.size(); ++c) {
      channels.push_back(
          {fmt::format("{}{}", layer, kAxes[first_axis + c]), ExrType::kFloat, &planes[c]});
    }
  };
  add("", *picture_, 0);
  add("noisy.", frame().lights[0].radiance, 0);
  add("N.", frame().surface.normal, 3);
  add("motion.", frame().motion, 3);
  channels.push_back({"Z", ExrType::kFloat, &frame().surface.depth});
  channels.push_back({"age", ExrType::kFloat, &denoiser_->age()});
  const ExrAttribute number{"eigenlight.frame", frame().index};
  write_exr(log_.recording_->directory / fmt::format("{}.exr", name), channels, {&number, 1});
}

const Planes<3>& StressRun::finish() {
  while (step()) {
  }
  return *picture_;
}

}  // namespace eigenlight
