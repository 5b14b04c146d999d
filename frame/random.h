// Counter-based random numbers: a value depends on its key alone, so order and threads never
// matter.
#pragma once

#include <cstdint>

namespace eigenlight {

/// Mixes 32 bits so that every input bit flips every output bit with probability near 1/2
/// (lowbias32; Wellons, hash prospector, bias 0.17).
[[nodiscard]] constexpr std::uint32_t mix32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  x ^= x >> 16;
  return x;
}

/// Hash of a key of several words, order-sensitive.
template <typename... Words>
[[nodiscard]] constexpr std::uint32_t hash_key(std::uint32_t first, Words... rest) {
  std::uint32_t h = mix32(first + 0x9e3779b9U);
  ((h = mix32(h ^ (static_cast<std::uint32_t>(rest) + 0x9e3779b9U + (h << 6) + (h >> 2)))), ...);
  return h;
}

/// Uniform in [0, 1): the upper 24 bits, which a float holds exactly.
[[nodiscard]] constexpr float to_unit(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

}  // namespace eigenlight
