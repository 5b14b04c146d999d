// What a run leaves beside its pictures: run.json, what it was; frames.jsonl, how each frame went.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "frame/plane.h"
#include "render/antialias/picture.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Everything that determines the bits of a run, and what a viewer needs to show it.
struct RunDescription {
  std::string scene, title;
  std::uint64_t scene_hash = 0;  ///< scene_hash() of what was loaded
  bool environment = false;
  std::vector<int> frames;
  Extent extent;
  int spp = 0, direct_spp = 0, bounces = 0;
  std::string method;
  std::string without;  ///< parts of the method that were off, with commas
  int bases = 0;
  std::uint32_t seed = 0;
  std::string perturb;
  std::string antialias = "none";
  std::string layers;
  float exposure = 1.0f;
};

/// The description as JSON text, with the program's name and version: the content of run.json.
[[nodiscard]] std::string to_json_text(const RunDescription& run);

/// The first difference of two such texts, for people: "spp is 3 there, 4 here". Empty if there is
/// none. Throws std::runtime_error if one is not a JSON object.
[[nodiscard]] std::string first_difference(std::string_view there, std::string_view here);

/// What became of a frame after it was denoised.
struct FrameOutput {
  StageTime write;
  StageTime antialias = {};
  PictureStats picture = {};
};

/// frames.jsonl: one JSON object a frame, in the order of the run.
///   frame, cut           number; whether no history was taken over
///   stages               {name: {wall_ms, cpu_ms}} of kStageNames, "antialias" and "write"
///   rays                 traced for this frame before antialiasing
///   antialias            {rays, unmatched, non_finite} of the picture: PictureStats
///   samples              of indirect light: spp * surface_pixels + extra_samples
///   extra_samples, surface_pixels, new_pixels
///   new_share            new_pixels / surface_pixels; 0 without surface
///   rank                 mean number of bases in use per tile with surface
///   skipped              {warp, surface, filter, geometry, guided, correction}, in pixels
///   non_finite_pixels, non_finite_samples, unguided_pixels, bounded_pixels
class RunLog {
 public:
  /// Keeps the first `kept` lines of an older log, which must be those of `frames`, and drops all
  /// others. Throws std::runtime_error naming the file (and line) if it holds fewer or other ones.
  RunLog(const std::filesystem::path& directory, const std::vector<int>& frames, std::size_t kept);

  /// Appends the line of a frame. Throws std::runtime_error naming the file if it cannot be
  /// written.
  void append(const FrameReport& report, int spp, const FrameOutput& output);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

/// Sums over the frames of one process, for the closing words.
struct RunTotals {
  std::size_t frames = 0;
  std::int64_t rays = 0;
  std::int64_t non_finite = 0;  ///< pixels and samples excluded
  double seconds = 0.0;
  std::array<StageTime, kStageNames.size()> time{};
  StageTime write, antialias;

  void add(const FrameReport& report, const FrameOutput& output);
  /// Million rays per second of wall time of the stages that trace them, source and resample.
  [[nodiscard]] double mega_rays_per_second() const;
  /// `frames`, `seconds`, `mrays_per_second`, `mean_ms` ({stage: {wall, cpu}}), `non_finite`,
  /// `directory`, as one line of JSON.
  [[nodiscard]] std::string to_json(const std::filesystem::path& directory) const;
  /// The same for people, one line.
  [[nodiscard]] std::string to_text(const std::filesystem::path& directory) const;
};

}  // namespace eigenlight
