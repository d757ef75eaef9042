/// A gyroscope about the vertical axis of base_link.
#pragma once

#include <cstdint>

#include "sim/drive.hpp"
#include "sim/random.hpp"

namespace kervan::sim {

/// How far the simulated gyroscope is from perfect. All may be 0.
struct GyroSettings {
  double bias = 0.0;   ///< rad/s; bound of a constant error, drawn once a run
  double scale = 0.0;  ///< bound of the scale error, drawn once a run; in [0, 1)
  double noise = 0.0;  ///< rad/s; standard deviation of the error of each reading
};

/// Integrates like a real rate-integrating gyroscope: a reading is the mean rate since the one before, so that readings
/// times their periods add up to the angle turned.
class Gyro {
 public:
  /// Throws std::invalid_argument if a setting is out of its range.
  Gyro(const GyroSettings& settings, const RandomSource& random);

  /// base_link has turned by so many radians.
  void add(double turn) { turned_ += turn; }

  /// The mean rate since the last reading, rad/s. `now` must be later than it; at 0 the gyroscope has not turned yet.
  double measure(const RandomSource& random, Duration now);

 private:
  GyroSettings settings_;
  double bias_ = 0.0;
  double scale_ = 1.0;
  double turned_ = 0.0;  // since the last reading
  Duration last_{0};
};

}  // namespace kervan::sim
