/// Random numbers that depend on what they are for and on nothing else: not on the order of calls, the number of
/// threads or where a component runs.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace kervan::sim {

/// Philox4x32-10: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3 (SC 2011).
inline std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// What a robot draws random numbers for.
enum class RandomUse : std::uint16_t {
  odometry_scale = 1,
  sonar = 2,
  laser = 3,
  sonar_incidence = 4,
  sonar_crosstalk = 5,
  wheel_scale = 6,
  wheel_slip = 7,
  gyro_scale = 8,
  gyro_noise = 9
};

/// The numbers of one robot in one run.
class RandomSource {
 public:
  /// The robot is known by its name, so that its numbers do not change when another robot is added before it.
  RandomSource(std::uint64_t seed, std::string_view robot);

  /// A sequence of independent numbers for one use of one part (sonar number 3) at one tick.
  class Sequence {
   public:
    double uniform() { return next()[0]; }  ///< in [0, 1), a multiple of 2^-53
    double uniform(double low, double high) { return low + (high - low) * uniform(); }  ///< in [low, high)
    double gaussian();  ///< mean 0, standard deviation 1 (Box and Muller 1958)
    /// As uniform() < probability, quicker if it is 0.
    bool happens(double probability) {
      if (probability > 0.0) return uniform() < probability;
      ++counter_[0];  // the number has its place in the sequence all the same
      return false;
    }

   private:
    friend class RandomSource;
    Sequence(std::array<std::uint32_t, 2> key, std::array<std::uint32_t, 4> counter) : key_(key), counter_(counter) {}
    /// Two uniform numbers.
    std::array<double, 2> next() {
      const auto words = philox4x32(counter_, key_);
      ++counter_[0];
      return {fraction(words[0], words[1]), fraction(words[2], words[3])};
    }
    static double fraction(std::uint32_t a, std::uint32_t b) {
      const std::uint64_t bits = (std::uint64_t{a} << 32 | b) >> 11;  // the 53 that a double holds
      return static_cast<double>(bits) * 0x1p-53;
    }

    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
  };
  Sequence at(RandomUse use, std::uint16_t part, std::uint64_t tick) const {
    const std::uint32_t purpose = static_cast<std::uint32_t>(use) << 16 | part;
    return {key_, {0, purpose, static_cast<std::uint32_t>(tick), static_cast<std::uint32_t>(tick >> 32)}};
  }

 private:
  std::array<std::uint32_t, 2> key_;
};

}  // namespace kervan::sim
