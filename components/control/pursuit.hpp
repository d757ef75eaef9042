/// Straight at the target, whatever lies between: the robot without avoidance that others are measured against.
#pragma once

#include "components/control/control_law.hpp"
#include "components/control/heading_drive.hpp"

namespace kervan::control {

/// Turns towards the target, on the spot if that is much (heading_drive.hpp), and comes to rest on it. A fault is a
/// pose, a speed or a target that is not finite. Robot and target in one frame.
Steering pursue(const HeadingDriveParams& params, const RobotState& robot, const geometry::Vector2& target);

}  // namespace kervan::control
