#include "components/mapping/robot_mask.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::mapping {

using geometry::Vector2;

void mask_robots(const geometry::Pose2& laser, const geometry::Scan& scan, std::span<const Vector2> robots,
                 double radius, std::span<float> ranges) {
  for (const Vector2& robot : robots) {
    const Vector2 way = robot - laser.position();
    const double distance = way.norm();
    if (!(distance <= scan.range_max + radius)) continue;
    const double bearing = std::atan2(way.y(), way.x());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double range = static_cast<double>(scan.ranges[i]);
      // Only what is as far away as the robot can be a part of it.
      if (!(std::abs(range - distance) <= radius)) continue;
      const double off = bearing - laser.yaw - scan.angle_min - static_cast<double>(i) * scan.angle_increment;
      const double apart2 = distance * distance + range * range - 2.0 * distance * range * std::cos(off);
      if (apart2 <= radius * radius) ranges[i] = -std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace kervan::mapping
