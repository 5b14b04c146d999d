#include "render/paths/sampler.h"

#include "frame/random.h"

namespace eigenlight {
namespace {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = (x >> 4 & 0x0f0f0f0fU) | (x & 0x0f0f0f0fU) << 4;
  x = (x >> 2 & 0x33333333U) | (x & 0x33333333U) << 2;
  return (x >> 1 & 0x55555555U) | (x & 0x55555555U) << 1;
}

// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it
// (Laine and Karras 2011, with the constants of Vegdahl 2021).
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

// Second Sobol dimension of `index`, bit-reversed. Its generator matrix is Pascal's triangle mod 2.
// By Lucas's theorem bit i is the parity of the index bits whose position contains all bits of i,
// which is a sum over supersets.
constexpr std::uint32_t sobol_reversed(std::uint32_t index) {
  std::uint32_t x = index;
  x ^= x >> 1 & 0x55555555U;
  x ^= x >> 2 & 0x33333333U;
  x ^= x >> 4 & 0x0f0f0f0fU;
  x ^= x >> 8 & 0x00ff00ffU;
  x ^= x >> 16;
  return x;
}

constexpr std::uint32_t kGolden = 0x9e3779b9U;  // 2^32 / golden ratio: spreads successive keys

}  // namespace

Sampler::Sampler(std::uint32_t key, std::uint32_t index)
    : key_(key), reversed_index_(reverse_bits(index)) {}

// Returns the shuffled index for the next pair. The shuffle is an Owen scrambling of the index.
std::uint32_t Sampler::next_index(std::uint32_t& seed) {
  key_ += kGolden;
  seed = mix32(key_);
  return reverse_bits(scramble_reversed(reversed_index_, seed));
}

float Sampler::next_1d() {
  std::uint32_t seed = 0;
  const std::uint32_t index = next_index(seed);
  return to_unit(reverse_bits(scramble_reversed(index, mix32(seed + 1U))));
}

glm::vec2 Sampler::next_2d() {
  std::uint32_t seed = 0;
  const std::uint32_t index = next_index(seed);
  const std::uint32_t x = scramble_reversed(index, mix32(seed + 1U));
  const std::uint32_t y = scramble_reversed(sobol_reversed(index), mix32(seed + 2U));
  return {to_unit(reverse_bits(x)), to_unit(reverse_bits(y))};
}

}  // namespace eigenlight
