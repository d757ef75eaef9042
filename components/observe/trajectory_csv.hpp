/// The driven paths as a table: one row a robot and instant.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

/// The first line of the table, without a line break.
inline constexpr std::string_view trajectory_header =
    "t_s,robot,x_m,y_m,yaw_rad,odom_x_m,odom_y_m,odom_yaw_rad,v_mps,w_radps";

struct TrajectoryRow {
  double time = 0.0;                    ///< s since the start of the run
  std::string_view robot;               ///< its name, which has no comma, quote or line break
  geometry::Pose2 truth;                ///< m and rad, map frame
  std::optional<geometry::Pose2> odom;  ///< where the robot believes to be; empty fields while it has not said
  geometry::Twist2 twist;               ///< true motion, m/s and rad/s
};

/// One line without a line break. Numbers have a point and a fixed number of decimals whatever the locale, so that
/// equal runs write equal files; what is not finite is an empty field.
std::string to_csv(const TrajectoryRow& row);

}  // namespace kervan::observe
