#include "components/control/control_law.hpp"

#include <cmath>

namespace kervan::control {

std::string_view fault_of(const RobotState& robot, const geometry::Vector2& target) {
  if (!robot.pose.position().allFinite() || !std::isfinite(robot.pose.yaw)) return "the pose is not finite";
  if (!std::isfinite(robot.twist.linear) || !std::isfinite(robot.twist.angular)) return "the speed is not finite";
  if (!target.allFinite()) return "the target is not finite";
  return {};
}

}  // namespace kervan::control
