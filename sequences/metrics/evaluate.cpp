#include "sequences/metrics/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "frame/bad_file.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/ldr_image.h"
#include "sequences/metrics/evaluate_images.h"
#include "sequences/metrics/layer_sequence.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

std::vector<LayerSequence> sequences_of(const EvaluateOptions& options) {
  std::vector<LayerSequence> sequences{parse_layer_sequence(options.test),
                                       parse_layer_sequence(options.reference)};
  if (!options.reference_b.empty()) sequences.push_back(parse_layer_sequence(options.reference_b));
  for (const LayerSequence& sequence : sequences) {
    const bool is_single = sequences.front().name.is_single();
    EL_CHECK(sequence.name.is_single() == is_single,
             "'{}' is one image and '{}' is a sequence; expected two of a kind",
             is_single ? options.test : sequence.name.text(),
             is_single ? sequence.name.text() : options.test);
    EL_CHECK(is_ldr_name(sequence.name.text()) == is_ldr_name(options.test),
             "'{}' and '{}': an 8-bit picture compares with 8-bit pictures only", options.test,
             sequence.name.text());
  }
  EL_CHECK(!options.reference_b.empty() ? !options.metrics.reference_noise.has_value() : true,
           "two references measure their noise themselves: leave the reference noise out");
  EL_CHECK(options.reference_b.empty() || options.reference_b != options.reference,
           "'{}' is named as both references, which must be independent", options.reference);
  return sequences;
}

std::vector<int> frames_of(const EvaluateOptions& options,
                           const std::vector<LayerSequence>& sequences) {
  if (!options.frames.empty()) {
    EL_CHECK(!sequences.front().name.is_single(), "frames {}: '{}' is one image", options.frames,
             options.test);
    return parse_frame_range(options.frames);
  }
  std::set<int> found;
  for (const LayerSequence& sequence : sequences) {
    if (sequence.name.is_single()) found.insert(0);
    for (const int frame : sequence.name.frames()) found.insert(frame);
  }
  if (found.empty()) throw BadFile(fmt::format("{}: no such files", options.test));
  return {found.begin(), found.end()};
}

// Reason by frame, for frames of which a file is missing.
std::map<int, std::string> missing_files(const std::vector<int>& frames,
                                         const std::vector<LayerSequence>& sequences) {
  std::map<int, std::string> missing;
  for (const int frame : frames) {
    for (const LayerSequence& sequence : sequences) {
      std::error_code error;
      if (fs::exists(sequence.name.path(frame), error)) continue;
      const std::string line = fmt::format("{}: no such file", sequence.name.path(frame).string());
      if (sequence.name.is_single()) throw BadFile(line);
      missing.emplace(frame, line);
    }
  }
  return missing;
}

[[noreturn]] void fail_missing(const std::map<int, std::string>& missing, std::size_t frames) {
  std::vector<int> numbers;
  for (const auto& [frame, reason] : missing) numbers.push_back(frame);
  throw std::runtime_error(fmt::format("{} ({} of {} frames are incomplete: {})",
                                       missing.begin()->second, missing.size(), frames,
                                       format_frame_range(numbers)));
}

FramePaths paths_of(int frame, const std::vector<LayerSequence>& sequences) {
  FramePaths paths{sequences[0].name.path(frame), sequences[1].name.path(frame), {}, {}};
  if (sequences.size() > 2) paths.reference_b = sequences[2].name.path(frame);
  for (std::size_t i = 0; i < sequences.size(); ++i) paths.prefixes[i] = sequences[i].prefix;
  return paths;
}

[[noreturn]] void fail_without_step(int step) {
  throw std::runtime_error(
      fmt::format("step {0}: expected mean light of the reference to change by {1:.0f} % or more "
                  "between frames {2} and {0}, both measured",
                  step, 100.0 * kLeastStep, step - 1));
}

std::vector<LightLevel> light_levels(const std::vector<FrameFigures>& frames) {
  std::vector<LightLevel> levels;
  for (const FrameFigures& frame : frames) {
    const Figures& figures = frame[PixelSet::kSurface];
    if (figures.pixels == 0) continue;
    levels.push_back({frame.frame, figures[Metric::kLight].value(),
                      figures[Metric::kReferenceLight].value(), figures[Metric::kRelmse].value()});
  }
  return levels;
}

// Frames from one to the next where the list has no gap.
int step_of(const std::vector<int>& frames) {
  int step = 1;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const int gap = std::abs(frames[i] - frames[i - 1]);
    step = i == 1 ? gap : std::min(step, gap);
  }
  return step;
}

// Where something of each frame comes from.
class Origins {
 public:
  void add(const std::string& origin, int frame) {
    auto found = std::find_if(frames_.begin(), frames_.end(),
                              [&](const auto& entry) { return entry.first == origin; });
    if (found == frames_.end()) found = frames_.insert(found, {origin, {}});
    found->second.push_back(frame);
  }
  /// The origin of all; several with their frames.
  [[nodiscard]] std::string text() const {
    if (frames_.size() < 2) return frames_.empty() ? "" : frames_.front().first;
    std::string text;
    for (const auto& [origin, frames] : frames_) {
      text +=
          fmt::format("{}{} in {}{}", text.empty() ? "" : ", ", origin.empty() ? "nowhere" : origin,
                      text.empty() ? "frames " : "", format_frame_range(frames));
    }
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::vector<int>>> frames_;
};

// Reads and measures frame after frame.
class Evaluator {
 public:
  /// `step`: of neighboring frames; others are not compared with one another.
  Evaluator(const EvaluateOptions& options, int step)
      : options_(options), metrics_(options.metrics), step_(step) {
    result_.metrics = options.metrics;
    result_.step = options.step;
  }

  void measure(int frame, const FramePaths& paths) {
    LoadedFrame loaded = load_frame(frame, paths, options_);
    if (!loaded.bad.empty()) {
      if (!options_.skips_bad) throw BadFile(loaded.bad);
      result_.bad_pixels += loaded.bad_pixels;
    }
    if (!result_.step && result_.frames.empty()) result_.step = loaded.step;
    loaded.images.follows = last_ && std::abs(frame - *last_) == step_;
    result_.frames.push_back(metrics_.add(std::move(loaded.images)));
    result_.outside_pixels += loaded.outside_pixels;
    surface_from_.add(loaded.surface_from, frame);
    age_from_.add(loaded.age_from, frame);
    if (!loaded.note.empty() && result_.notes.empty()) result_.notes.push_back(loaded.note);
    last_ = frame;
  }
  void skip(int frame, std::string reason) {
    result_.skipped.push_back({frame, std::move(reason)});
    last_.reset();
  }
  [[nodiscard]] Evaluation finish() && {
    if (result_.frames.empty()) {
      throw std::runtime_error(
          fmt::format("no frame could be measured; {}", result_.skipped.front().reason));
    }
    result_.mean = mean_figures(result_.frames);
    result_.surface_from = surface_from_.text();
    result_.age_from = age_from_.text();
    if (result_.step) result_.lag = measure_lag(light_levels(result_.frames), *result_.step);
    if (options_.step && !result_.lag) fail_without_step(*options_.step);
    return std::move(result_);
  }

 private:
  const EvaluateOptions& options_;
  SequenceMetrics metrics_;
  Evaluation result_;
  Origins surface_from_, age_from_;
  int step_;
  std::optional<int> last_;  // frame that was measured last
};

}  // namespace

Evaluation evaluate(const EvaluateOptions& given) {
  EvaluateOptions options = given;
  options.metrics.is_display = is_ldr_name(options.test);
  const std::vector<LayerSequence> sequences = sequences_of(options);
  const std::vector<int> frames = frames_of(options, sequences);
  const auto missing = missing_files(frames, sequences);
  if (!missing.empty() && !options.skips_bad) fail_missing(missing, frames.size());

  Evaluator evaluator(options, step_of(frames));
  for (const int frame : frames) {
    if (const auto found = missing.find(frame); found != missing.end()) {
      evaluator.skip(frame, found->second);
      continue;
    }
    try {
      evaluator.measure(frame, paths_of(frame, sequences));
    } catch (const std::runtime_error& error) {
      if (!options.skips_bad) throw;
      evaluator.skip(frame, error.what());
    }
  }
  return std::move(evaluator).finish();
}

}  // namespace eigenlight
