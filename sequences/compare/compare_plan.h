// What `eigenlight compare` compares, as given and as checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frame/plane.h"
#include "render/antialias/options.h"
#include "sequences/compare/external_method.h"
#include "sequences/compare/recorded_shot.h"
#include "sequences/runs/flythrough.h"

namespace eigenlight {

/// As a user gives it.
struct CompareSettings {
  /// SCENE, or SCENE:PERTURB with commas in place of `perturb`; or EXR patterns of recorded frames,
  /// the inputs of one shot.
  std::vector<std::string> scenes;
  std::string methods;  ///< with commas; empty: all
  std::string spp = "1,2,3,4,8,16";
  std::string frames = "40-59";
  int warmup = 40;
  std::string size = "640x360";
  int bases = 3;
  int bounces = 3;
  std::int64_t seed = 0;
  std::string perturb = "none";  ///< with commas; of scenes that do not name their own
  bool environment = false;
  int reference_spp = 1024;
  std::string cache = "out/references";
  std::vector<std::string> external, external_time;
  std::optional<double> equal_time;  ///< ms a frame
  bool ablate = false;
  std::string antialias;  ///< with commas; not empty: compare these ways of antialiasing
  std::string crop;       ///< WIDTHxHEIGHT+X+Y; empty: no picture of crops
  int crops_per_row = 0;  ///< 0: all in one row
  std::string markdown;   ///< file for the tables, `-` for standard output; empty: none
  std::string paper;      ///< not empty: rerun it; `size` and `frames` are then empty if not given
  std::string directory;
  std::string layer;  ///< what is measured; empty: `indirect` of scenes, beauty of recorded frames
  // Of recorded frames only.
  std::string reference, reference_b;  ///< as RecordedShot has them
  LayerChoice layers;
  GuideChoice guides;
  std::string cuts;
};

/// One column of the comparison: a method of ours, perhaps without one of its parts, a program, or
/// a way of antialiasing.
struct Contender {
  std::string label;  ///< unique, can be part of a file name
  std::string method;
  std::string without;  ///< a part that is off, or empty
  std::optional<ExternalMethod> external;
  std::optional<AntialiasOptions> antialias = std::nullopt;
};

/// One scene under one perturbation.
struct CompareCase {
  std::string name;   ///< unique, can be part of a file name: `atrium`, `atrium-lights`
  std::string scene;  ///< as given
  std::string perturb;
  Perturbation perturbation = Perturbation::kNone;
};

/// A rectangle of the picture, and how many of its crops stand in a row.
struct CropPlan {
  int x = 0, y = 0;
  Extent size;
  int per_row = 0;  ///< 0: all
};

struct ComparePlan {
  std::vector<CompareCase> cases;
  std::vector<Contender> contenders;
  std::vector<int> spp;       ///< ascending
  std::vector<int> measured;  ///< ascending; without a gap unless they are recorded
  /// Those before them for history, and the measured ones; of recorded frames also those between
  /// and behind.
  std::vector<int> frames;
  Extent extent;
  int bases = 3, bounces = 3;
  std::uint32_t seed = 0;
  bool environment = false;
  int reference_spp = 0;  ///< of each of the two references
  std::optional<double> equal_time;
  bool is_whole = false;  ///< scenes: the picture with direct light and emission is measured
  std::optional<CropPlan> crop;
  std::optional<RecordedShot> recorded;  ///< in place of scenes: one case stands for it
  std::filesystem::path cache, directory;

  /// The sample count that pictures and tables are of: 3, the default of `eigenlight render`, else
  /// the one next to it.
  [[nodiscard]] int shown_spp() const;
  /// The contender that others are measured by: `eigenlight`, else the first.
  [[nodiscard]] const Contender& ours() const;
  /// The contender whose errors others are given as multiples of: `noisy`, or no antialiasing. Null
  /// if it is not compared.
  [[nodiscard]] const Contender* baseline() const;
  /// That sample count for people, `3 spp`, and `behind`; empty of recorded frames.
  [[nodiscard]] std::string shown_text(std::string_view behind = {}) const;
  /// What is measured, for people: `indirect light times albedo`.
  [[nodiscard]] std::string measured_light() const;
  /// What the references are, for people.
  [[nodiscard]] std::string reference_text() const;
  /// Whether contenders are ways of antialiasing, measured on the composed picture.
  [[nodiscard]] bool is_antialiasing() const;
};

/// The reference of antialiased pictures: supersampling at 16 places of each pixel.
inline constexpr AntialiasOptions kAntialiasReference{AntialiasMode::kSupersample, 16};

/// Throws std::invalid_argument naming the option, what was given and what was expected.
[[nodiscard]] ComparePlan make_compare_plan(const CompareSettings& settings);

}  // namespace eigenlight
