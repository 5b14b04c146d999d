// Which way of antialiasing, as a user names it.
#pragma once

#include <string>
#include <string_view>

namespace eigenlight {

enum class AntialiasMode {
  kNone,          ///< one ray through each pixel center
  kLookup,        ///< Bauszat 2011, 3.2: further eye rays look indirect light up
  kSraa,          ///< Chiu 2012: further geometry samples take all light from shaded neighbors
  kSraaGeometry,  ///< the same without shadow samples: Chajdas 2011
  kSupersample,   ///< everything is path-traced at each of several places of a pixel
};

struct AntialiasOptions {
  AntialiasMode mode = AntialiasMode::kNone;
  int samples = 1;  ///< per pixel, [2, kMaxSupersamples]; of kSupersample alone
};

inline constexpr int kMaxSupersamples = 1024;

/// `none`, `lookup`, `sraa`, `sraa-geometry` or `supersample:N`. Throws std::invalid_argument
/// listing these, or naming the range of N.
[[nodiscard]] AntialiasOptions parse_antialias(std::string_view text);
/// The text that parse_antialias() takes.
[[nodiscard]] std::string format_antialias(const AntialiasOptions& options);

}  // namespace eigenlight
