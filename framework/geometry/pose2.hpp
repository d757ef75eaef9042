/// Poses and velocities in the plane: metres, radians, x forward, y left, yaw counter-clockwise (REP-103).
#pragma once

#include <Eigen/Core>

#include "framework/geometry/angle.hpp"

namespace kervan::geometry {

using Vector2 = Eigen::Vector2d;

/// The unit vector in the direction `yaw`.
inline Vector2 heading(double yaw) { return {std::cos(yaw), std::sin(yaw)}; }

/// Where a frame sits in its parent frame. yaw is kept as given; the operations return it in (-pi, pi].
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  Vector2 position() const { return {x, y}; }

  /// A point of this frame, seen in the parent frame.
  Vector2 operator*(const Vector2& point) const {
    const double c = std::cos(yaw), s = std::sin(yaw);
    return {x + c * point.x() - s * point.y(), y + s * point.x() + c * point.y()};
  }

  /// A pose given in this frame, seen in the parent frame.
  Pose2 operator*(const Pose2& pose) const {
    const Vector2 p = *this * pose.position();
    return {p.x(), p.y(), wrap_angle(yaw + pose.yaw)};
  }

  /// The parent frame, seen in this frame.
  Pose2 inverse() const {
    const double c = std::cos(yaw), s = std::sin(yaw);
    return {-c * x - s * y, s * x - c * y, wrap_angle(-yaw)};
  }

  bool operator==(const Pose2&) const = default;
};

/// Velocity of a base that cannot move sideways: forward in m/s, turning in rad/s.
struct Twist2 {
  double linear = 0.0;
  double angular = 0.0;

  bool operator==(const Twist2&) const = default;
};

}  // namespace kervan::geometry
