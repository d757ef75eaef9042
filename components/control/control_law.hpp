/// What control laws have in common: what each is told besides the obstacles, and what it answers.
#pragma once

#include <string_view>

#include "framework/geometry/pose2.hpp"
#include "framework/geometry/scan.hpp"

namespace kervan::control {

/// Of base_link, by the odometry.
struct RobotState {
  geometry::Pose2 pose = {};    ///< in a frame that target and obstacles share
  geometry::Twist2 twist = {};  ///< with which it moves
};

/// A scan, and where the laser was when it was taken, in the frame of the robot's pose.
struct PlacedScan {
  geometry::Pose2 laser;
  geometry::Scan scan;
};

/// What of these no law can work with; empty: nothing.
std::string_view fault_of(const RobotState& robot, const geometry::Vector2& target);

enum class Outcome {
  drives,    ///< to its target
  hindered,  ///< its command is to be obeyed, but does not bring it to the target: nothing is free there
  fault,     ///< with its inputs it cannot tell: the robot stands
};

/// What a law makes of its robot, the target and the obstacles. A law is a class of values, with
///   step(const RobotState&, const geometry::Vector2& target, <what it sees>)
/// that returns this or more, does not allocate once it has run, and is called once a period.
struct Steering {
  Outcome outcome = Outcome::drives;
  std::string_view why = {};    ///< one sentence without a full stop, in static memory; empty if it drives
  geometry::Twist2 twist = {};  ///< to command; zero with a fault
};

}  // namespace kervan::control
