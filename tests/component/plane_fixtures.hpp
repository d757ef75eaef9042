/// Messages for component tests.
#pragma once

#include <initializer_list>
#include <string>

#include "framework/geometry/messages.hpp"
#include "framework/component/value.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::test {

inline nav_msgs::msg::Odometry odometry_at(const geometry::Pose2& pose, const geometry::Twist2& twist = {}) {
  nav_msgs::msg::Odometry message;
  message.header.frame_id = "odom";
  message.child_frame_id = "base_link";
  message.pose.pose = geometry::to_message(pose);
  message.twist.twist = geometry::to_message(twist);
  return message;
}

inline geometry_msgs::msg::PoseStamped pose_at(double x, double y) {
  geometry_msgs::msg::PoseStamped message;
  message.header.frame_id = "map";
  message.pose = geometry::to_message(geometry::Pose2{x, y, 0.0});
  return message;
}

inline geometry_msgs::msg::TwistStamped twist_of(double linear, double angular) {
  geometry_msgs::msg::TwistStamped message;
  message.header.frame_id = "base_link";
  message.twist = geometry::to_message(geometry::Twist2{linear, angular});
  return message;
}

inline Value points(std::initializer_list<std::pair<double, double>> list) {
  ValueList result;
  for (const auto& [x, y] : list) result.push_back(ValueList{x, y});
  return result;
}

inline Value pairs(std::initializer_list<std::pair<int, int>> list) {
  ValueList result;
  for (const auto& [a, b] : list) result.push_back(ValueList{a, b});
  return result;
}

}  // namespace kervan::test
