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

double fraction(std::uint32_t a, std::uint32_t b) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(a) << 32 | b) >> 11;  // the 53 that a double holds
  return static_cast<double>(bits) * 0x1p-53;
}

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {high(b) ^ counter[1] ^ key[0], low(b), high(a) ^ counter[3] ^ key[1], low(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

RandomSource::RandomSource(std::uint64_t seed, std::string_view robot) {
  // One more block of the cipher turns seed and name into the key, so that neighbouring seeds share nothing.
  const std::uint64_t name = hash(robot);
  const auto mixed = philox4x32({low(name), high(name), 0, 0}, {low(seed), high(seed)});
  key_ = {mixed[0], mixed[1]};
}

RandomSource::Sequence RandomSource::at(RandomUse use, std::uint16_t part, std::uint64_t tick) const {
  const std::uint32_t purpose = static_cast<std::uint32_t>(use) << 16 | part;
  return {key_, {0, purpose, low(tick), high(tick)}};
}

std::array<double, 2> RandomSource::Sequence::next() {
  const auto words = philox4x32(counter_, key_);
  ++counter_[0];
  return {fraction(words[0], words[1]), fraction(words[2], words[3])};
}

double RandomSource::Sequence::uniform() { return next()[0]; }

double RandomSource::Sequence::uniform(double low, double high) { return low + (high - low) * uniform(); }

bool RandomSource::Sequence::happens(double probability) {
  if (probability > 0.0) return uniform() < probability;
  ++counter_[0];  // the number has its place in the sequence all the same
  return false;
}

double RandomSource::Sequence::gaussian() {
  const auto [a, b] = next();
  return std::sqrt(-2.0 * std::log(1.0 - a)) * std::cos(2.0 * std::numbers::pi * b);
}

}  // namespace kervan::sim
