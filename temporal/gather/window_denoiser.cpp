#include "temporal/gather/window_denoiser.h"

#include <algorithm>

#include "frame/check.h"
#include "frame/tiles.h"
#include "temporal/gather/count_pixels.h"
#include "temporal/gather/even_light.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Ratios to smaller colors say nothing: 8-bit textures cannot tell these apart.
constexpr float kLeastColor = 0.01f;

const WindowOptions& checked(const WindowOptions& options) {
  options.validate();
  return options;
}

void validate_tuning(const LightTuning& tuning) {
  tuning.test.validate();
  EL_CHECK(tuning.sigmas > 0.0f && tuning.sigmas <= 100.0f, "sigmas {}: expected (0, 100]",
           tuning.sigmas);
}

}  // namespace

WindowOptions::WindowOptions() {
  pilot.radius = 1;
  filter.radius = 1;
  filter.passes = 5;
}

void WindowOptions::validate() const {
  EL_CHECK(ahead >= 0 && ahead <= kMostGathered, "ahead {}: expected 0 to {}", ahead,
           kMostGathered);
  EL_CHECK(past >= 0 && past <= kMostGathered, "past {}: expected 0 to {}", past, kMostGathered);
  guides.validate();
  for (const LightTuning& tuning : {direct, diffuse, glossy}) validate_tuning(tuning);
  EL_CHECK(color_width > 0.0f, "color_width {}: expected more than 0", color_width);
  EL_CHECK(emission_width > 0.0f, "emission_width {}: expected more than 0", emission_width);
  EL_CHECK(pilot_sigmas > 0.0f && pilot_sigmas <= 100.0f, "pilot_sigmas {}: expected (0, 100]",
           pilot_sigmas);
}

WindowDenoiser::WindowDenoiser(Extent extent, int layers, const WindowOptions& options)
    : options_(checked(options)),
      extent_(extent),
      recorder_(extent, layers, options.pilot, options.pilot_sigmas),
      filter_(extent, options.filter) {
  EL_CHECK(layers >= 1 && layers <= kMaxLights, "{} layers of light, expected 1 to {}", layers,
           kMaxLights);
  for (int i = 0; i < layers; ++i) {
    outputs_.push_back(make_planes<3>(extent));
    variances_.emplace_back(extent);
  }
}

const LightTuning& WindowDenoiser::tuning_of(const NoisyLight& light) const {
  if (light.is_direct) return options_.direct;
  return light.is_glossy ? options_.glossy : options_.diffuse;
}

// Layers whose colors are the same memory share a record.
void WindowDenoiser::record_colors(const FrameInput& frame, std::span<const Planes<3>> emission,
                                   Record& record) {
  std::vector<const float*> known;
  record.color_of.assign(frame.lights.size(), -1);
  for (std::size_t i = 0; i < frame.lights.size(); ++i) {
    const Planes<3>& color = frame.lights[i].color;
    if (color[0].empty()) continue;
    const float* memory = color[0].row(extent_.height / 2);
    const auto found = std::find(known.begin(), known.end(), memory);
    record.color_of[i] = static_cast<int>(found - known.begin());
    if (found != known.end()) continue;
    known.push_back(memory);
    if (record.colors.size() < known.size()) record.colors.emplace_back();
    record_color(color, record.colors[known.size() - 1]);
  }
  record.colors.resize(known.size() + emission.size());
  record.scales.resize(emission.size());
  for (std::size_t i = 0; i < emission.size(); ++i) {
    EL_CHECK(emission[i][0].extent() == extent_, "frame {}: size of emission differs", frame.index);
    record_emission(emission[i], record.colors[known.size() + i], record.scales[i]);
  }
}

void WindowDenoiser::count(const FrameInput& frame, Record& record) const {
  FrameReport& report = record.report;
  report = {};
  report.frame = frame.index;
  const bool has_before =
      records_.size() > 1 && records_[records_.size() - 2].index == record.previous_index;
  report.cut = !has_before;
  const auto is_surface = [&](int x, int y) { return shows_surface(record.guides(x, y)); };
  report.surface_pixels = count_pixels(extent_, is_surface);
  report.non_finite_pixels = count_pixels(extent_, [&](int x, int y) {
    return is_surface(x, y) &&
           std::any_of(record.lights.begin(), record.lights.end(),
                       [&](const LightRecord& light) { return light(x, y).usable == 0.0f; });
  });
  report.new_pixels = has_before ? count_new(record.back, record.guides,
                                             records_[records_.size() - 2].guides, options_.guides)
                                 : report.surface_pixels;
}

WindowDenoiser::Record& WindowDenoiser::add_record(const FrameInput& frame,
                                                   std::span<const Planes<3>> emission) {
  EL_CHECK(frame.lights.size() == outputs_.size(), "frame {}: {} layers of light, expected {}",
           frame.index, frame.lights.size(), outputs_.size());
  EL_CHECK(frame.extent() == extent_, "frame {}: its size differs", frame.index);
  StageClock clock;
  records_.emplace_back();
  Record& record = records_.back();
  if (!spare_.empty()) {
    record = std::move(spare_.back());
    spare_.pop_back();
  }
  record.index = frame.index;
  record.previous_index = frame.previous_index;
  record.tuning.clear();
  for (const NoisyLight& light : frame.lights) record.tuning.push_back(tuning_of(light));
  record.lights.resize(frame.lights.size());
  pack_guides(frame, options_.guides, record.guides);
  link_back(frame, record.back);
  recorder_.record(frame, record.guides, record.lights);
  record_colors(frame, emission, record);
  count(frame, record);
  if (!record.report.cut && records_.size() - next_ >= 2) {
    Record& before = records_[records_.size() - 2];
    link_ahead_.find(record.back, record.guides, before.guides, options_.guides, before.ahead);
  }
  record.report[Stage::kWarp] += clock.lap();
  return record;
}

void WindowDenoiser::push(const FrameInput& frame, std::span<const Planes<3>> emission) {
  add_record(frame, emission);
}

void WindowDenoiser::push_past(const FrameInput& frame, std::span<const Planes<3>> emission) {
  EL_CHECK(next_ == records_.size(), "frame {}: frames to be denoised wait already", frame.index);
  add_record(frame, emission);
  ++next_;
  drop_used();
}

// Frames before or after the one at hand, up to a cut.
GatherWalk WindowDenoiser::walk(int direction, int frames) const {
  GatherWalk steps;
  const bool is_ahead = direction > 0;
  const std::size_t colors = records_[next_].colors.size();
  for (std::size_t at = next_; static_cast<int>(steps.size()) < frames;) {
    if (is_ahead ? at + 1 == records_.size() : at == 0) break;
    const Record& here = records_[at];
    at = is_ahead ? at + 1 : at - 1;
    const Record& there = records_[at];
    const bool is_linked =
        is_ahead ? there.previous_index == here.index : here.previous_index == there.index;
    if (!is_linked || there.colors.size() != colors) break;
    GatherStep& step = steps.emplace_back();
    step.link = is_ahead ? &here.ahead : &here.back;
    step.guides = &there.guides;
    for (const LightRecord& light : there.lights) step.lights.push_back(&light);
    for (const ColorRecord& color : there.colors) step.colors.push_back(&color);
  }
  return steps;
}

void WindowDenoiser::gather_all(const Record& record) {
  const std::vector<GatherWalk> walks{walk(-1, options_.past), walk(1, options_.ahead)};
  std::vector<GatherLayer> layers;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    layers.push_back({&record.lights[i], record.tuning[i].test, &outputs_[i], &variances_[i]});
  }
  std::vector<GatherColor> colors;
  while (colors_.size() < record.colors.size()) colors_.push_back(make_planes<3>(extent_));
  emission_at_ = record.colors.size() - record.scales.size();
  for (std::size_t i = 0; i < record.colors.size(); ++i) {
    const bool is_emission = i >= emission_at_;
    colors.push_back({&record.colors[i],
                      is_emission ? options_.emission_width : options_.color_width, &colors_[i]});
  }
  gather(record.guides, options_.guides, walks, layers, colors);
}

// Multiplies light by the steadied color over the frame's own.
void WindowDenoiser::apply_colors(const Record& record, std::size_t layer) {
  if (record.color_of[layer] < 0) return;
  const auto index = static_cast<std::size_t>(record.color_of[layer]);
  const ColorRecord& own = record.colors[index];
  const Planes<3>& steady = colors_[index];
  Planes<3>& light = outputs_[layer];
  parallel_for(extent_.height, [&](int y) {
    for (int x = 0; x < extent_.width; ++x) {
      const PackedColor& from = own(x, y);
      if (from.usable == 0 || !shows_surface(record.guides(x, y))) continue;
      const std::uint16_t channels[3] = {from.r, from.g, from.b};
      for (std::size_t c = 0; c < 3; ++c) {
        const float color = static_cast<float>(channels[c]) * kColorStep;
        if (color >= kLeastColor) light[c](x, y) *= steady[c](x, y) / color;
      }
    }
  });
}

void WindowDenoiser::scale_emission(const Record& record) {
  for (std::size_t i = 0; i < record.scales.size(); ++i) {
    Planes<3>& emission = colors_[emission_at_ + i];
    parallel_for(extent_.height, [&](int y) {
      for (int x = 0; x < extent_.width; ++x) {
        for (auto& plane : emission) plane(x, y) *= record.scales[i](x, y);
      }
    });
  }
}

bool WindowDenoiser::step() {
  const auto ahead = static_cast<std::size_t>(options_.ahead);
  if (next_ == records_.size()) return false;
  if (!is_finished_ && records_.size() <= next_ + ahead) return false;
  StageClock clock;
  Record& record = records_[next_];
  gather_all(record);
  record.report[Stage::kProject] += clock.lap();
  std::vector<SoftLayer> filtered;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    filtered.push_back({&outputs_[i], &variances_[i], record.tuning[i].sigmas});
  }
  filter_.process(record.guides, filtered);
  record.report[Stage::kFilter] += clock.lap();
  // Not of emission: what flickers at the edges of a lamp is the number of samples that hit it.
  for (std::size_t i = 0; i < emission_at_; ++i) even_light(record.colors[i], colors_[i]);
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    even_light(record.lights[i], outputs_[i]);
    apply_colors(record, i);
  }
  scale_emission(record);
  record.report[Stage::kCorrect] += clock.lap();
  report_ = record.report;
  ++next_;
  drop_used();
  return true;
}

void WindowDenoiser::drop_used() {
  while (next_ > static_cast<std::size_t>(options_.past)) {
    spare_.push_back(std::move(records_.front()));
    records_.pop_front();
    --next_;
  }
}

}  // namespace eigenlight
