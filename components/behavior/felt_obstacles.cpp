#include "components/behavior/felt_obstacles.hpp"

namespace kervan::behavior {

namespace {
constexpr double same = 0.1;  // m
}

void FeltObstacles::add(const geometry::Vector2& point, Time now) {
  if (!point.allFinite()) return;
  for (Obstacle& known : obstacles_) {
    if ((known.point - point).norm() > same) continue;
    known.felt = now;
    return;
  }
  obstacles_.push_back({point, now});
}

std::vector<geometry::Vector2> FeltObstacles::seen_from(const geometry::Pose2& robot, Time now) {
  std::erase_if(obstacles_, [&](const Obstacle& known) { return now - known.felt > keep_; });
  const geometry::Pose2 to_robot = robot.inverse();
  std::vector<geometry::Vector2> points;
  for (const Obstacle& known : obstacles_) points.push_back(to_robot * known.point);
  return points;
}

}  // namespace kervan::behavior
