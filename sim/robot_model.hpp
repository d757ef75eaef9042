/// What a kind of robot is: body, limits and where its sensors sit. Data; robots/*.yaml gives it with its sources.
/// SI units and radians, in the robot's frame base_link: the point between the driven wheels, x forward, y left.
#pragma once

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

struct RobotModel {
  std::string name;
  Outline outline;
  DriveLimits drive;
  SonarRing sonars;
};

/// Throws std::invalid_argument with one sentence that says which value cannot be.
void require_valid(const RobotModel& model);

}  // namespace kervan::sim
