// References on disk, so that a second comparison is cheap.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/live_source.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// What long work reports to, and asks.
struct RunControl {
  std::function<void(int)> frame_done;  ///< called after each frame, with its number
  std::function<bool()> stops;          ///< asked after each frame: true ends the work
};

struct AnimatedScene {
  const Scene& scene;
  const Animation& animation;
};

/// All that decides the bits of references but the frame number.
struct ReferenceIdentity {
  std::string scene;  ///< for people, perturbation included: can be part of a file name
  std::uint64_t scene_hash = 0;
  std::string perturb;
  Extent extent;
  int bounces = 0;
  int spp = 0;                 ///< of each of the two
  std::uint32_t seed = 0;      ///< below 2^30
  std::uint64_t renderer = 0;  ///< renderer_hash()
  /// Of the indirect light times albedo where absent, else of the composed picture, antialiased in
  /// this way; `spp` is then what its samples of a pixel have together.
  std::optional<AntialiasOptions> antialias = std::nullopt;
  /// Of the composed picture without antialiasing.
  bool is_whole = false;

  [[nodiscard]] bool shows_all() const { return is_whole || antialias; }
};

/// What the renderer makes of a scene: a hash of frame 0 at one sample a pixel, of the indirect
/// light, or of the composed or the antialiased picture. A change of the renderer that keeps the
/// bits of those paths keeps the references valid.
[[nodiscard]] std::uint64_t renderer_hash(
    const AnimatedScene& animated, const RenderOptions& options,
    const std::optional<AntialiasOptions>& antialias = std::nullopt, bool is_whole = false);

/// Two independent renderings A and B of each frame, one EXR file each, in a directory named after
/// the scene and a hash of the identity. What is there is used, frame by frame, so that a stopped
/// rendering goes on where it was.
class ReferenceCache {
 public:
  enum class Half { kA, kB };
  static constexpr Half kHalves[] = {Half::kA, Half::kB};

  ReferenceCache(const std::filesystem::path& root, const ReferenceIdentity& identity);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::vector<int> missing(Half half, const std::vector<int>& frames) const;
  /// Renders `frames` of one half. The scene must be that of the identity. Throws
  /// std::runtime_error naming what cannot be written.
  void render(Half half, const std::vector<int>& frames, const AnimatedScene& animated,
              const RunControl& control) const;
  /// Throws std::runtime_error naming the file if it cannot be read or is of another size.
  [[nodiscard]] Planes<3> load(Half half, int frame) const;

 private:
  [[nodiscard]] std::filesystem::path file(Half half, int frame) const;

  ReferenceIdentity identity_;
  std::filesystem::path path_;
};

}  // namespace eigenlight
