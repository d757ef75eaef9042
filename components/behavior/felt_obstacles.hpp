/// Obstacles that a robot has run into and no sonar hears.
#pragma once

#include <vector>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::behavior {

/// Keeps the places of contacts for some time, so that a robot which has freed itself does not drive straight back.
class FeltObstacles {
 public:
  explicit FeltObstacles(Duration keep) : keep_(keep) {}

  /// A contact at `point`, in the frame of the odometry. One within 0.1 m of a remembered one is the same obstacle,
  /// felt again. Points that are not finite are left out.
  void add(const geometry::Vector2& point, Time now);

  /// Those felt within the last `keep`, seen from `robot`, the pose of base_link in the frame of the odometry.
  std::vector<geometry::Vector2> seen_from(const geometry::Pose2& robot, Time now);

 private:
  struct Obstacle {
    geometry::Vector2 point;
    Time felt;
  };

  Duration keep_;
  std::vector<Obstacle> obstacles_;
};

}  // namespace kervan::behavior
