#include "components/control/pursuit.hpp"

#include <cmath>

namespace kervan::control {

Steering pursue(const HeadingDriveParams& params, const RobotState& robot, const geometry::Vector2& target) {
  if (const std::string_view fault = fault_of(robot, target); !fault.empty()) return {Outcome::fault, fault};
  const geometry::Vector2 way = target - robot.pose.position();
  const double distance = way.norm();
  if (distance == 0.0) return {};
  return {.twist = drive_in_direction(params, geometry::angle_between(robot.pose.yaw, std::atan2(way.y(), way.x())),
                                      distance)};
}

}  // namespace kervan::control
