/// Where a robot is on its route.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::planning {

/// Follows a robot along a line of points. Its place moves on steadily: where a route comes back to its beginning, or
/// passes on the other side of a wall, the robot is not taken to be there before it drove there.
class RoutePlace {
 public:
  /// Starts a route; points in metres. A robot is taken to be at its first point.
  void start(const std::vector<geometry::Vector2>& points);

  /// Looks for the robot no farther along the route than it can have come since the last call, and some more. A
  /// position that is not finite changes nothing.
  void move(const geometry::Vector2& position);

  bool empty() const { return points_.empty(); }
  double along() const { return along_; }                ///< m, from the beginning of the route
  double remaining() const { return length_ - along_; }  ///< m, to its end
  double off() const { return off_; }                    ///< m, from the robot to its place on the route

 private:
  std::vector<geometry::Vector2> points_;
  double length_ = 0.0;
  double along_ = 0.0;
  double off_ = 0.0;
  std::size_t leg_ = 0;  // the robot is on the line to the point behind this one
  double leg_at_ = 0.0;  // m along the route, where that leg begins
  geometry::Vector2 last_ = geometry::Vector2::Zero();
};

}  // namespace kervan::planning
