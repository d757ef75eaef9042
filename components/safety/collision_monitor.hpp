/// Looks at where a command would drive the robot, and slows or stops it before it touches anything.
#pragma once

#include <span>
#include <string_view>

#include "framework/geometry/pose2.hpp"
#include "framework/geometry/rectangular_hull.hpp"

namespace kervan::safety {

struct CollisionMonitorParams {
  geometry::RectangularHull hull = {};
  double stop_margin = 0.02;        ///< m around the hull, the stop zone: no motion may bring anything into it
  double slow_margin = 0.30;        ///< m around the hull, the slow zone
  double slow_speed = 1.0;          ///< m/s, the most with something in the slow zone
  double time_to_collision = 0.45;  ///< s, that has to remain at the speed commanded: else it is lowered
  double max_reverse = 0.3;         ///< m/s, the most backward, where the sensor may see nothing
};

enum class Verdict {
  passed,   ///< the command as it came
  slowed,   ///< more slowly along the same arc
  stopped,  ///< zero
};

struct Checked {
  geometry::Twist2 twist;
  Verdict verdict = Verdict::passed;
  std::string_view why = {};  ///< one sentence without a full stop; empty if it passed
  double time = 0.0;          ///< s to the collision at the speed that was asked for; time_to_collision if it is later
};

/// Holds nothing from one command to the next. The arc of the command, driven at once and for time_to_collision, is
/// looked at every 20 ms: where the stop zone meets a point, or where the hull comes nearer to a point that is in the
/// zone already, the collision begins. Its time t leaves the command multiplied by t / time_to_collision, so the robot
/// comes to a stop before what it drives at. It may always drive away from what is too near.
class CollisionMonitor {
 public:
  explicit CollisionMonitor(const CollisionMonitorParams& params) : params_(params) {}

  void set_params(const CollisionMonitorParams& params) { params_ = params; }

  /// `points`: obstacles in base_link, m. A command that is not finite is stopped.
  Checked check(const geometry::Twist2& wanted, std::span<const geometry::Vector2> points) const;

 private:
  double nearest(const geometry::Pose2& robot, std::span<const geometry::Vector2> points) const;
  double time_to_collision(const geometry::Twist2& twist, std::span<const geometry::Vector2> points) const;

  CollisionMonitorParams params_;
};

}  // namespace kervan::safety
