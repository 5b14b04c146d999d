#include "temporal/gather/window_denoiser.h"

#include <limits>

#include "frame/check.h"
#include "frame/memory_source.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

DenoiserOptions with_one_basis(DenoiserOptions options) {
  options.bases = 1;
  return options;
}

const WindowOptions& checked(const WindowOptions& options) {
  options.validate();
  return options;
}

// A value that was used before, or a new one.
template <typename T>
T take(std::vector<T>& spare) {
  if (spare.empty()) return {};
  T value = std::move(spare.back());
  spare.pop_back();
  return value;
}

}  // namespace

WindowOptions::WindowOptions() {
  eigen.even_gain = true;
  eigen.filter = false;
  eigen.look_back = false;
  eigen.young_age = 0.0f;
  // As good as no bound: what it takes from outliers is missing in the picture, and means over 3 x
  // 3 pixels let the filter spread them.
  eigen.fireflies.deviations = 1000.0f;
  eigen.fireflies.times = 1000.0f;
  pilot.radius = 1;
  filter.passes = 5;
}

void WindowOptions::validate() const {
  EL_CHECK(ahead >= 0 && ahead <= kMostGathered, "ahead {}: expected 0 to {}", ahead,
           kMostGathered);
  EL_CHECK(past >= 0 && past <= kMostGathered, "past {}: expected 0 to {}", past, kMostGathered);
  guides.validate();
  gather.validate();
  for (const float value : {sigmas, direct_sigmas, pilot_sigmas}) {
    EL_CHECK(value > 0.0f && value <= 100.0f, "sigmas {}: expected (0, 100]", value);
  }
}

WindowDenoiser::WindowDenoiser(const DenoiserOptions& options, const WindowOptions& tuning)
    : options_(checked(tuning)),
      eigen_(with_one_basis(options), tuning.eigen),
      recorder_(options.extent, options.layers, tuning.pilot, tuning.pilot_sigmas),
      filter_(options.extent, tuning.filter) {
  for (int i = 0; i < options.layers; ++i) {
    outputs_.push_back(make_planes<3>(options.extent));
    variances_.emplace_back(options.extent);
  }
}

WindowDenoiser::Record& WindowDenoiser::add_record(const Frame& frame) {
  EL_CHECK(frame.lights.size() == outputs_.size(), "frame {}: {} layers of light, expected {}",
           frame.index, frame.lights.size(), outputs_.size());
  EL_CHECK(frame.extent() == outputs_.front()[0].extent(), "frame {}: its size differs",
           frame.index);
  Record& record = records_.emplace_back(take(spare_));
  record.index = frame.index;
  record.previous_index = frame.previous_index;
  record.is_direct.clear();
  for (const NoisyLight& light : frame.lights) record.is_direct.push_back(light.is_direct);
  for (std::size_t i = 0; i < outputs_.size(); ++i) record.lights.push_back(take(spare_lights_));
  pack_guides(frame, options_.guides, record.guides);
  link_back(frame, record.back);
  recorder_.record(frame, record.guides, record.lights);
  return record;
}

void WindowDenoiser::record_estimates(Record& record) {
  const Extent extent = record.guides.extent();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    record.estimates.emplace_back();
    record.variances.emplace_back();
    record.ages.emplace_back();
    if (record.is_direct[i]) continue;
    const int layer = static_cast<int>(i);
    record.estimates[i] = take(spare_estimates_);
    record.variances[i] = take(spare_planes_);
    record.ages[i] = take(spare_planes_);
    ensure_extent(record.estimates[i], extent);
    ensure_extent(record.variances[i], extent);
    ensure_extent(record.ages[i], extent);
    copy_planes(eigen_.output(layer), record.estimates[i]);
    record.variances[i].copy_from(eigen_.variance(layer));
    record.ages[i].copy_from(eigen_.age(layer));
  }
}

// Later frames gather direct light alone from it.
void WindowDenoiser::release(Record& record) {
  for (std::size_t i = 0; i < record.estimates.size(); ++i) {
    if (record.is_direct[i]) continue;
    spare_estimates_.push_back(std::move(record.estimates[i]));
    spare_planes_.push_back(std::move(record.variances[i]));
    spare_planes_.push_back(std::move(record.ages[i]));
    spare_lights_.push_back(std::move(record.lights[i]));
  }
  record.estimates.clear();
  record.variances.clear();
  record.ages.clear();
}

void WindowDenoiser::link_to(Record& before, const Record& record) {
  link_ahead_.find(record.back, record.guides, before.guides, options_.guides, before.ahead);
  before.changes.resize(outputs_.size());
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    if (record.is_direct[i]) continue;
    before.changes[i].find(before.estimates[i], record.estimates[i], before.ahead);
  }
}

void WindowDenoiser::push(Frame& frame) {
  StageClock clock;
  Record& record = add_record(frame);
  const StageTime recorded = clock.lap();
  OneFrameSource source(frame);
  if (!eigen_.step(source)) throw std::logic_error("the loop did not take a frame");
  record.report = eigen_.report();
  (void)clock.lap();
  record_estimates(record);
  if (records_.size() - next_ >= 2) {
    Record& before = records_[records_.size() - 2];
    if (record.previous_index == before.index) link_to(before, record);
  }
  record.report[Stage::kFilter] += recorded;
  record.report[Stage::kFilter] += clock.lap();
}

void WindowDenoiser::push_past(const Frame& frame) {
  EL_CHECK(next_ == records_.size(), "frame {}: frames to be denoised wait already", frame.index);
  release(add_record(frame));
  ++next_;
  drop_used();
}

// Frames before or after the one at hand, up to a cut.
GatherWalk WindowDenoiser::walk(int direction, int frames) const {
  GatherWalk steps;
  const bool is_ahead = direction > 0;
  for (std::size_t at = next_; static_cast<int>(steps.size()) < frames;) {
    if (is_ahead ? at + 1 == records_.size() : at == 0) break;
    const Record& here = records_[at];
    at = is_ahead ? at + 1 : at - 1;
    const Record& there = records_[at];
    const bool is_linked =
        is_ahead ? there.previous_index == here.index : here.previous_index == there.index;
    if (!is_linked) break;
    GatherStep& step = steps.emplace_back();
    step.link = is_ahead ? &here.ahead : &here.back;
    step.guides = &there.guides;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      const bool is_direct = there.is_direct[i];
      step.lights.push_back(is_ahead || is_direct ? &there.lights[i] : nullptr);
      step.changes.push_back(is_ahead && !is_direct ? &here.changes[i] : nullptr);
    }
  }
  return steps;
}

// Direct light starts with the frame's own.
void WindowDenoiser::start_output(const Record& record, std::size_t layer) {
  Planes<3>& output = outputs_[layer];
  if (!record.is_direct[layer]) {
    copy_planes(record.estimates[layer], output);
    variances_[layer].copy_from(record.variances[layer]);
    return;
  }
  const LightRecord& own = record.lights[layer];
  parallel_for(own.height(), [&](int y) {
    for (int x = 0; x < own.width(); ++x) {
      const RecordedLight& from = own(x, y);
      const bool is_usable = from.usable != 0.0f;
      output[0](x, y) = is_usable ? from.r : kNone;
      output[1](x, y) = is_usable ? from.g : kNone;
      output[2](x, y) = is_usable ? from.b : kNone;
      variances_[layer](x, y) = from.noise;
    }
  });
}

bool WindowDenoiser::step() {
  const auto ahead = static_cast<std::size_t>(options_.ahead);
  if (next_ == records_.size()) return false;
  if (!is_finished_ && records_.size() <= next_ + ahead) return false;
  StageClock clock;
  Record& record = records_[next_];
  const std::vector<GatherWalk> walks{walk(-1, options_.past), walk(1, options_.ahead)};
  std::vector<GatherLayer> gathered;
  std::vector<SoftLayer> filtered;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    start_output(record, i);
    gathered.push_back({&record.lights[i], &outputs_[i], &variances_[i],
                        record.is_direct[i] ? nullptr : &record.ages[i]});
    filtered.push_back({&outputs_[i], &variances_[i],
                        record.is_direct[i] ? options_.direct_sigmas : options_.sigmas});
  }
  gather(record.guides, options_.guides, walks, gathered, options_.gather);
  filter_.process(record.guides, filtered);
  report_ = record.report;
  report_[Stage::kFilter] += clock.lap();
  release(record);
  ++next_;
  drop_used();
  return true;
}

void WindowDenoiser::drop_used() {
  while (next_ > static_cast<std::size_t>(options_.past)) {
    Record& oldest = records_.front();
    for (LightRecord& light : oldest.lights) {
      if (!light.empty()) spare_lights_.push_back(std::move(light));
    }
    oldest.lights.clear();
    spare_.push_back(std::move(oldest));
    records_.pop_front();
    --next_;
  }
}

}  // namespace eigenlight
