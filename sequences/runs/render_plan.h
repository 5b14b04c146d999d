// The options of `eigenlight render`, before and after checking.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/live_source.h"
#include "sequences/runs/flythrough.h"
#include "sequences/runs/frame_writer.h"

namespace eigenlight {

inline constexpr std::string_view kDefaultMethod = "eigenlight";
/// The method that renders references: many samples, no denoising, and seeds that no other run has.
inline constexpr std::string_view kReferenceMethod = "reference";
inline constexpr int kReferenceSpp = 512;
/// Of direct light, which has far less noise.
inline constexpr int kReferenceDirectSpp = 64;

/// Options as a user gives them.
struct RenderSettings {
  std::string scene;
  std::string directory;
  std::string frames = "0-47";
  std::string size = "640x360";
  std::optional<int> spp;           ///< 3, or kReferenceSpp for `reference`
  std::optional<int> direct_spp;    ///< that of RenderOptions, or kReferenceDirectSpp
  std::string direct = "denoised";  ///< or `noisy`
  std::string method{kDefaultMethod};
  std::string without;  ///< comma-separated parts of the method to turn off; empty: none
  int bases = 3;
  std::int64_t seed = 0;
  int bounces = 3;
  std::string perturb = "none";
  std::string antialias = "lookup";
  std::string layers;  ///< empty: all
  bool environment = false;
  bool resume = false;
};

/// Checked options.
struct RenderPlan {
  RenderOptions render;
  std::vector<int> frames;
  std::string method;    ///< as the user named it
  std::string denoiser;  ///< name of the denoiser: `noisy` for `reference`
  std::vector<std::string> without;
  int bases = 3;
  /// Direct light is denoised too: where it is shown, unless the method leaves all light noisy.
  bool denoises_direct = false;
  Perturbation perturbation = Perturbation::kNone;
  std::string perturb;
  AntialiasOptions antialias;
  std::vector<Layer> layers;
};

/// `640x360`. Throws std::invalid_argument on anything else, or sides beyond [1, kMaxSide].
[[nodiscard]] Extent parse_size(std::string_view text);

/// Throws std::invalid_argument naming the option, its value and what was expected; also if frames
/// of that size exceed the memory of the machine.
[[nodiscard]] RenderPlan make_plan(const RenderSettings& settings);

}  // namespace eigenlight
