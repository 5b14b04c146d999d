#include "sequences/compare/recorded_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "frame/bad_file.h"
#include "frame/check.h"
#include "sequences/compare/compare_contenders.h"
#include "sequences/files/frame_range.h"
#include "sequences/metrics/layer_sequence.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

// `shot.####.exr` gives `shot`.
std::string shot_word(const std::string& pattern) {
  std::string name = fs::path(pattern).filename().string();
  name = name.substr(0, name.find_first_of("#@%"));
  while (!name.empty() && (name.back() == '.' || name.back() == '_' || name.back() == '-')) {
    name.pop_back();
  }
  return name.empty() ? "shot" : file_word(name);
}

// Methods that recorded frames cannot feed, and why.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kNotOnFiles{
    {{"chen2012", "it asks for 120 samples at new pixels, which files cannot give"},
     {"meyer2006", "it reads the whole sequence ahead, which is compared on scenes only"}}};

void check_contenders(const std::vector<Contender>& contenders) {
  for (const Contender& contender : contenders) {
    for (const auto& [method, why] : kNotOnFiles) {
      EL_CHECK(contender.method != method, "method '{}': not on recorded frames: {}", method, why);
    }
  }
}

void check_settings(const CompareSettings& settings) {
  for (const std::string& input : settings.scenes) {
    EL_CHECK(is_exr_name(input),
             "scene '{}': recorded frames such as '{}' are compared without scenes", input,
             *std::find_if(settings.scenes.begin(), settings.scenes.end(), is_exr_name));
    EL_CHECK(!SequenceName(input).is_single(),
             "'{}': expected a pattern such as shot.####.exr for recorded frames", input);
  }
  EL_CHECK(!settings.reference.empty(),
           "recorded frames need --reference, such as shot.ref.####.exr or "
           "shot.ref.####.exr:HalfA");
  for (const std::string& text : {settings.reference, settings.reference_b}) {
    EL_CHECK(text.empty() || !parse_layer_sequence(text).name.is_single(),
             "reference '{}': expected a pattern such as shot.ref.####.exr", text);
  }
  EL_CHECK(settings.reference != settings.reference_b,
           "'{}' is named as both references, which must be independent", settings.reference);
  EL_CHECK(!settings.ablate, "ablate: parts of a method are turned off on scenes only");
  EL_CHECK(settings.antialias.empty(), "aa: antialiasing is compared on scenes only");
  EL_CHECK(settings.warmup >= 0, "warmup {}: expected 0 or more", settings.warmup);
}

std::vector<SequenceName> measured_sequences(const CompareSettings& settings) {
  std::vector<SequenceName> names(settings.scenes.begin(), settings.scenes.end());
  names.push_back(parse_layer_sequence(settings.reference).name);
  if (!settings.reference_b.empty()) {
    names.push_back(parse_layer_sequence(settings.reference_b).name);
  }
  return names;
}

void check_exist(const std::vector<int>& frames, const std::vector<SequenceName>& sequences) {
  for (const int frame : frames) {
    for (const SequenceName& sequence : sequences) {
      std::error_code error;
      if (fs::exists(sequence.path(frame), error)) continue;
      throw BadFile(fmt::format("{}: no such file", sequence.path(frame).string()));
    }
  }
}

std::vector<int> measured_frames(const CompareSettings& settings) {
  const std::vector<SequenceName> sequences = measured_sequences(settings);
  std::vector<int> frames;
  if (!settings.frames.empty()) {
    frames = parse_frame_range(settings.frames);
    std::sort(frames.begin(), frames.end());
    check_exist(frames, sequences);
    return frames;
  }
  frames = sequences.front().frames();
  if (frames.empty()) throw BadFile(fmt::format("{}: no such files", sequences.front().text()));
  for (const SequenceName& sequence : sequences) {
    const std::vector<int> there = sequence.frames();
    std::erase_if(frames,
                  [&](int f) { return !std::binary_search(there.begin(), there.end(), f); });
    if (!frames.empty()) continue;
    throw BadFile(
        fmt::format("{}: no frame of '{}' is there", sequence.text(), sequences.front().text()));
  }
  return frames;
}

void set_frames(const CompareSettings& settings, ComparePlan& plan) {
  plan.measured = measured_frames(settings);
  const std::vector<int> all = SequenceName(settings.scenes.front()).frames();
  for (const int frame : all) {
    if (frame >= plan.measured.front() - settings.warmup) plan.frames.push_back(frame);
  }
  // All frames: holes are then found as in `denoise`.
  if (plan.frames != all) plan.recorded->denoise.files.frames = format_frame_range(plan.frames);
}

RecordedShot make_shot(const CompareSettings& settings) {
  RecordedShot shot;
  shot.denoise.files.inputs = settings.scenes;
  shot.denoise.layers = settings.layers;
  shot.denoise.guides = settings.guides;
  shot.denoise.cuts = settings.cuts;
  shot.denoise.resume = true;
  shot.reference = settings.reference;
  shot.reference_b = settings.reference_b;
  if (!settings.layer.empty()) shot.layer = settings.layer;
  return shot;
}

}  // namespace

bool is_recorded(const CompareSettings& settings) {
  return std::any_of(settings.scenes.begin(), settings.scenes.end(), is_exr_name);
}

Planes<3> read_shot_layer(const std::vector<fs::path>& files, const std::string& layer) {
  for (const fs::path& path : files) {
    const ExrReader reader(path);
    if (reader.has_layer(layer)) return reader.read_planes<3>(layer);
  }
  return ExrReader(files.front()).read_planes<3>(layer);  // says what it has
}

ComparePlan make_recorded_plan(const CompareSettings& given) {
  CompareSettings settings = given;
  check_settings(settings);
  if (settings.methods.empty()) settings.methods = "eigenlight,noisy";
  ComparePlan plan;
  plan.recorded = make_shot(settings);
  plan.contenders = make_contenders(settings);
  check_contenders(plan.contenders);
  set_frames(settings, plan);
  const int first = plan.measured.front();
  std::vector<fs::path> files;
  for (const std::string& input : settings.scenes) files.push_back(SequenceName(input).path(first));
  plan.extent = read_shot_layer(files, plan.recorded->layer)[0].extent();
  const std::string name = shot_word(settings.scenes.front());
  plan.cases = {{name, settings.scenes.front(), "none"}};
  plan.spp = {0};
  plan.crop = make_crop(settings, plan.extent);
  plan.directory = settings.directory;
  return plan;
}

}  // namespace eigenlight
