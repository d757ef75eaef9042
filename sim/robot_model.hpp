/// What a kind of robot is: body, limits and where its sensors sit. Data; robots/*.yaml gives it with its sources.
/// SI units and radians, in the robot's frame base_link: the point between the driven wheels, x forward, y left.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/outline.hpp"

namespace kervan::sim {

/// Limits of a differential drive. All positive.
struct DriveLimits {
  double speed = 0.0;                 ///< m/s, forward and backward
  double turn_rate = 0.0;             ///< rad/s, to either side
  double acceleration = 0.0;          ///< m/s2, away from standstill
  double deceleration = 0.0;          ///< m/s2, towards standstill
  double angular_acceleration = 0.0;  ///< rad/s2, away from and towards standstill
};

/// A set of equal sonars.
struct SonarRing {
  double min_range = 0.0;      ///< m; nearer echoes are reported at this distance
  double max_range = 0.0;      ///< m; farther ones are not heard
  double field_of_view = 0.0;  ///< rad, the whole cone
  std::vector<Pose2> poses;    ///< of the transducers, looking along their x axis, in the order of their numbers
};

/// A planar laser range finder. Its beams are spread evenly over the field of view: the first and the last stand at its
/// edges, and beam i is the next one to the left of beam i - 1.
struct LaserMount {
  Pose2 pose;                  ///< of the device, which looks along its x axis
  int beams = 0;               ///< at least 2
  double field_of_view = 0.0;  ///< rad, between the first and the last beam; less than a full turn
  double min_range = 0.0;      ///< m; nearer echoes are not measured
  double max_range = 0.0;      ///< m; farther ones neither
};

/// rad between neighbouring beams.
inline double beam_spacing(const LaserMount& laser) { return laser.field_of_view / (laser.beams - 1); }

struct RobotModel {
  std::string name;
  Outline outline;
  DriveLimits drive;
  SonarRing sonars = {};
  std::optional<LaserMount> laser = std::nullopt;
};

/// Throws std::invalid_argument with one sentence that says which value cannot be.
void require_valid(const RobotModel& model);

}  // namespace kervan::sim
