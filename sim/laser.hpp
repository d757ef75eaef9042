/// A planar laser range finder: a fan of rays, each reporting the first thing it meets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/random.hpp"
#include "sim/robot_model.hpp"
#include "sim/surroundings.hpp"

namespace kervan::sim {

/// How far the simulated laser is from perfect. All may be 0.
struct LaserSettings {
  double noise = 0.005;      ///< m; bound of a uniform error of each range
  double noise_share = 0.0;  ///< standard deviation of another error, as a share of the range
  double drop_out = 0.0;     ///< probability that a beam brings nothing back, in [0, 1]
};

class Laser {
 public:
  /// Throws std::invalid_argument if a setting is out of its range. `mount` must be valid (require_valid).
  Laser(const LaserMount& mount, const LaserSettings& settings);

  std::size_t size() const { return directions_.size(); }
  const LaserMount& mount() const { return mount_; }

  /// What each beam reads with the robot at `pose`, in m, into `ranges` (size() of them): the distance from the device
  /// to the first obstacle or robot. +infinity if there is none within max_range, -infinity if it is nearer than
  /// min_range (REP 117). `scan` numbers the scans of a run.
  void measure(const Surroundings& around, const Pose2& pose, const RandomSource& random, std::uint64_t scan,
               std::span<double> ranges) const;

 private:
  LaserMount mount_;
  LaserSettings settings_;
  std::vector<Vector2> directions_;  // of the beams in base_link
};

}  // namespace kervan::sim
