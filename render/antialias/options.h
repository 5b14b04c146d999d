// Antialiasing modes and their names on the command line.
#pragma once

#include <string>
#include <string_view>

namespace eigenlight {

enum class AntialiasMode {
  kNone,          ///< one ray through each pixel center
  kLookup,        ///< Bauszat 2011, 3.2: extra camera rays take indirect light from a guide ray
  kSraa,          ///< Chiu 2012: extra camera rays take all light from similar guide rays
  kSraaGeometry,  ///< Chajdas 2011: kSraa without shadow rays
  kSupersample,   ///< all light is path-traced at several positions in each pixel
};

struct AntialiasOptions {
  AntialiasMode mode = AntialiasMode::kNone;
  int samples = 1;  ///< per pixel, [2, kMaxSupersamples]; only used by kSupersample
};

inline constexpr int kMaxSupersamples = 1024;

/// Parses `none`, `lookup`, `sraa`, `sraa-geometry` or `supersample:N`. Throws
/// std::invalid_argument that lists these names or gives the range of N.
[[nodiscard]] AntialiasOptions parse_antialias(std::string_view text);
/// The text that parse_antialias() turns into `options`.
[[nodiscard]] std::string format_antialias(const AntialiasOptions& options);

}  // namespace eigenlight
