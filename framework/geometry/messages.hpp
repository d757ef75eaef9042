/// Poses, speeds, scans and times of the plane as the ROS 2 messages carry them. What the plane does not have (z, roll,
/// pitch) is ignored on the way in and zero on the way out.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "builtin_interfaces/msg/Duration.hpp"
#include "builtin_interfaces/msg/Time.hpp"
#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"
#include "framework/geometry/scan.hpp"
#include "geometry_msgs/msg/Pose.hpp"
#include "geometry_msgs/msg/Twist.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "std_msgs/msg/Header.hpp"

namespace kervan::geometry {

inline builtin_interfaces::msg::Time to_message(Time time) {
  constexpr std::int64_t second = 1'000'000'000;
  const std::int64_t since = time.time_since_epoch().count();
  const std::int64_t part = (since % second + second) % second;  // nanosec is always added, before the epoch too
  builtin_interfaces::msg::Time message;
  message.sec = static_cast<std::int32_t>((since - part) / second);
  message.nanosec = static_cast<std::uint32_t>(part);
  return message;
}

inline Time time_of(const builtin_interfaces::msg::Time& message) {
  return Time(std::chrono::seconds(message.sec) + Duration(message.nanosec));
}

/// "SEC.NANOSEC", nine digits behind the point: how a GoalStatus names the goal with this stamp.
inline std::string goal_id_of(const builtin_interfaces::msg::Time& stamp) {
  std::string nanoseconds = std::to_string(stamp.nanosec);
  nanoseconds.insert(0, nanoseconds.size() < 9 ? 9 - nanoseconds.size() : 0, '0');
  return std::to_string(stamp.sec) + "." + nanoseconds;
}

inline builtin_interfaces::msg::Duration to_message(Duration duration) {
  const builtin_interfaces::msg::Time parts = to_message(Time(duration));
  builtin_interfaces::msg::Duration message;
  message.sec = parts.sec;
  message.nanosec = parts.nanosec;
  return message;
}

inline Duration duration_of(const builtin_interfaces::msg::Duration& message) {
  return std::chrono::seconds(message.sec) + Duration(message.nanosec);
}

inline void set_header(std_msgs::msg::Header& header, Time stamp, const std::string& frame) {
  header.stamp = to_message(stamp);
  header.frame_id = frame;
}

inline Vector2 position_of(const geometry_msgs::msg::Pose& pose) { return {pose.position.x, pose.position.y}; }

inline Pose2 pose_of(const geometry_msgs::msg::Pose& pose) {
  const auto& q = pose.orientation;
  return {pose.position.x, pose.position.y,
          std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))};
}

inline Twist2 twist_of(const geometry_msgs::msg::Twist& twist) { return {twist.linear.x, twist.angular.z}; }

/// Its ranges are those of the message, which must live as long.
inline Scan scan_of(const sensor_msgs::msg::LaserScan& scan) {
  return {static_cast<double>(scan.angle_min), static_cast<double>(scan.angle_increment),
          static_cast<double>(scan.range_min), static_cast<double>(scan.range_max), scan.ranges};
}

inline geometry_msgs::msg::Pose to_message(const Pose2& pose) {
  geometry_msgs::msg::Pose message;
  message.position.x = pose.x;
  message.position.y = pose.y;
  message.orientation.z = std::sin(0.5 * pose.yaw);
  message.orientation.w = std::cos(0.5 * pose.yaw);
  return message;
}

inline geometry_msgs::msg::Twist to_message(const Twist2& twist) {
  geometry_msgs::msg::Twist message;
  message.linear.x = twist.linear;
  message.angular.z = twist.angular;
  return message;
}

}  // namespace kervan::geometry
