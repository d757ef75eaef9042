#include "sim/random.hpp"

#include <cmath>
#include <numbers>

namespace kervan::sim {

namespace {

std::uint32_t low(std::uint64_t v) { return static_cast<std::uint32_t>(v); }
std::uint32_t high(std::uint64_t v) { return static_cast<std::uint32_t>(v >> 32); }

/// FNV-1a, 64 bits.
std::uint64_t hash(std::string_view text) {
  std::uint64_t h = 0xcbf29ce484222325u;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return h;
}

}  // namespace

RandomSource::RandomSource(std::uint64_t seed, std::string_view robot) {
  // One more block of the cipher turns seed and name into the key, so that neighbouring seeds share nothing.
  const std::uint64_t name = hash(robot);
  const auto mixed = philox4x32({low(name), high(name), 0, 0}, {low(seed), high(seed)});
  key_ = {mixed[0], mixed[1]};
}

double RandomSource::Sequence::gaussian() {
  const auto [a, b] = next();
  return std::sqrt(-2.0 * std::log(1.0 - a)) * std::cos(2.0 * std::numbers::pi * b);
}

}  // namespace kervan::sim
