/// What moves along a script: data, as a world file gives it. Metres and radians, in the frame `map`.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "sim/outline.hpp"

namespace kervan::sim {

/// Where an obstacle is at a time of the simulation. The yaw is turned through as it is written: from 0 to 2 pi is a
/// full turn.
struct Waypoint {
  std::chrono::nanoseconds at{0};
  Pose2 pose;
};

/// Stands at its first waypoint until that one's time, then moves from each to the next at constant speed.
struct MovingObstacle {
  std::string name;
  Outline outline;  ///< around its pose
  std::vector<Waypoint> path;
  bool repeat = false;  ///< goes on from the first waypoint behind the last one; else it stays there
};

/// Throws std::invalid_argument if it has no name, its path is empty or not finite, the times do not grow from 0 on, or
/// it is to repeat a path that does not end where it began.
void require_valid(const MovingObstacle& obstacle);

/// Where the script wants it at `time`.
Pose2 pose_at(const MovingObstacle& obstacle, std::chrono::nanoseconds time);

/// The same place, and the same direction.
bool same_place(const Pose2& a, const Pose2& b);

/// Outlines of a rectangle around its middle, and of a disc: a regular polygon of 32 corners on its edge, nowhere more
/// than half a percent of the radius within it.
Outline rectangle_outline(const Vector2& size);
Outline disc_outline(double radius);

}  // namespace kervan::sim
