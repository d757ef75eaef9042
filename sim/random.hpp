/// Random numbers that depend on what they are for and on nothing else: not on the order of calls, the number of
/// threads or where a component runs.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace kervan::sim {

/// Philox4x32-10: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3 (SC 2011).
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

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
    double uniform();                         ///< in [0, 1), a multiple of 2^-53
    double uniform(double low, double high);  ///< in [low, high)
    double gaussian();                        ///< mean 0, standard deviation 1 (Box and Muller 1958)
    bool happens(double probability);         ///< as uniform() < probability, quicker if it is 0

   private:
    friend class RandomSource;
    Sequence(std::array<std::uint32_t, 2> key, std::array<std::uint32_t, 4> counter) : key_(key), counter_(counter) {}
    std::array<double, 2> next();  // two uniform numbers

    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
  };
  Sequence at(RandomUse use, std::uint16_t part, std::uint64_t tick) const;

 private:
  std::array<std::uint32_t, 2> key_;
};

}  // namespace kervan::sim
